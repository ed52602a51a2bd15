"""Frozen records: the standard library's data classes, with all methods but `__init__` written once, for all of them.

`dataclasses` compiles six methods anew for each class, and a short command makes two hundred of them: a tenth of its time.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:
    import dataclasses
    from dataclasses import MISSING, FrozenInstanceError, fields
    from reprlib import recursive_repr

    def dataclass(cls=None, /, *, frozen=False, eq=True):
        """As `dataclasses.dataclass`; a frozen one gets the methods below, unless it has its own. Nothing else is changed."""
        if cls is None:
            return lambda cls: dataclass(cls, frozen=frozen, eq=eq)
        if not frozen:
            return dataclasses.dataclass(cls, eq=eq)
        shared = {"__setattr__": _refuse, "__delattr__": _refuse, "__repr__": _text}
        shared |= {"__eq__": _equal, "__hash__": _hash} if eq else {}
        for name in shared.keys() - cls.__dict__.keys():
            setattr(cls, name, shared[name])
        made = dataclasses.dataclass(cls, init=False, repr=False, eq=False)
        made.__init__ = _init(made)
        made._compared = tuple(each.name for each in fields(made) if each.compare)
        return made

    def _init(cls):
        """A function that takes the fields, their defaults as the class has them, and sets them."""
        known = {"_set": object.__setattr__, "_default": MISSING}
        takes, does = ["self"], []
        for each in fields(cls):
            name, value = each.name, each.name
            if each.default_factory is not MISSING:
                known[f"_make_{name}"] = each.default_factory
                value = f"_make_{name}() if {name} is _default else {name}" if each.init else f"_make_{name}()"
                takes += [f"{name}=_default"] if each.init else []
            elif not each.init:
                continue
            elif each.default is not MISSING:
                known[f"_default_{name}"] = each.default
                takes.append(f"{name}=_default_{name}")
            else:
                takes.append(name)
            does.append(f" _set(self, {name!r}, {value})")
        if hasattr(cls, "__post_init__"):
            does.append(" self.__post_init__()")
        exec(f"def __init__({', '.join(takes)}):\n" + "\n".join(does or [" pass"]), known)
        known["__init__"].__qualname__ = f"{cls.__qualname__}.__init__"
        return known["__init__"]

    def _refuse(self, name, value=None):
        raise FrozenInstanceError(f"{name!r} of a {type(self).__qualname__} cannot be set")

    def _values(record):
        return tuple([getattr(record, name) for name in record._compared])

    def _equal(self, other):
        return _values(self) == _values(other) if other.__class__ is self.__class__ else NotImplemented

    def _hash(self):
        return hash(_values(self))

    @recursive_repr()
    def _text(self):
        told = (f"{each.name}={getattr(self, each.name)!r}" for each in fields(self) if each.repr)
        return f"{self.__class__.__qualname__}({', '.join(told)})"
