"""Motions in, animations out: clips, retargeting by bone maps, `.glb`, `.usdc`, video."""

from .._lazy import lazy_modules

MODULES = ("animate", "bone_map", "clips", "usd")
__getattr__, __dir__ = lazy_modules(__name__, MODULES)
