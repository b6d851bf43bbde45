"""Facial expressions: the one place that names them."""

from typing import Literal, get_args

AdultExpression = Literal["neutral", "happy", "sad", "surprised", "angry", "disgusted", "scared"]
"""Those of a caregiver."""
Expression = Literal["neutral", "happy", "sad", "surprised", "angry", "disgusted", "scared", "sleepy", "crying"]
"""Those of an infant."""
ADULT_EXPRESSIONS: tuple[AdultExpression, ...] = get_args(AdultExpression)
EXPRESSIONS: tuple[Expression, ...] = get_args(Expression)
