"""Tells Gymnasium the environments of this package, if it is installed."""

from __future__ import annotations


def register() -> None:
    """Registers ``hyped/Level-v0``."""
    try:
        from gymnasium.envs import registration
    except ImportError:
        return
    if "hyped/Level-v0" not in registration.registry:
        registration.register(
            id="hyped/Level-v0",
            entry_point="hyped.env:LevelEnv",
            vector_entry_point="hyped.env:LevelVectorEnv",
        )
