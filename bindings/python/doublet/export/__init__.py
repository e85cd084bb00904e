"""Motions in, animations out: clips, retargeting by bone maps, `.glb`, `.usdc`, textures, video, garments for other solvers."""

from .._lazy import lazy_modules

MODULES = ("animate", "bone_map", "bone_names", "character_edit", "clips", "cloth", "level_of_detail", "usd", "vertex_animation")
__getattr__, __dir__ = lazy_modules(__name__, MODULES)
