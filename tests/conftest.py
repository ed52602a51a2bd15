"""What all tests share."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

# However long examples take, for a machine may be busy; on a build server the same ones each time, so that a red run can be
# run again, elsewhere new ones.
settings.register_profile(
    "camgen", derandomize=bool(os.environ.get("CI")), deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("camgen")

ROOT = Path(__file__).resolve().parent.parent


@pytest.fixture
def root() -> Path:
    return ROOT


@pytest.fixture
def starter() -> Path:
    return ROOT / "specs" / "uniform-swing.toml"
