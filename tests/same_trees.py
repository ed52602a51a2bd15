"""Whether a change is of form alone: the Python files whose syntax trees are not those of another commit.

    python tests/same_trees.py COMMIT

Layout and comments are no part of a tree, nor is the indent of a docstring. Ends with 1 where a tree differs, or a file is new
or gone.
"""

from __future__ import annotations

import ast
import inspect
import subprocess
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent


def git(*arguments: str) -> str:
    """What git prints."""
    run = subprocess.run(["git", *arguments], cwd=TOP, check=True, capture_output=True)
    return run.stdout.decode()


def tree(source: str) -> str:
    """A file's syntax tree as text, without line numbers."""
    module = ast.parse(source)
    for node in ast.walk(module):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(
            node
        ):
            text = node.body[0].value  # type: ignore[attr-defined]
            text.value = inspect.cleandoc(text.value)
    return ast.dump(module)


def differing(commit: str) -> list[str]:
    """Files that do not mean what they meant."""
    before = set(git("ls-tree", "-r", "--name-only", commit).splitlines())
    now = set(git("ls-files").splitlines())
    files = sorted(name for name in before | now if name.endswith(".py"))
    return [
        name
        for name in files
        if name not in before & now
        or tree(git("show", f"{commit}:{name}")) != tree((TOP / name).read_text(encoding="utf-8"))
    ]


if __name__ == "__main__":
    others = differing(sys.argv[1])
    print(*others, f"{len(others)} files differ in their syntax trees", sep="\n")
    sys.exit(bool(others))
