"""Judges engines that compute distances and depths of convex bodies, on hard cases with exact answers.

`python -m lin_canny_referee --engine coal` prints a table; README.md describes it, and how to write an
adapter for another engine.
"""

from .adapter import Adapter, Answer, Tolerance
from .cases import Case, Pose, Shape

__version__ = "0.1.0"
__all__ = ["Adapter", "Answer", "Case", "Pose", "Shape", "Tolerance", "__version__"]
