"""The `looks` of a body: colours of skin, hair and eyes, and clothes."""

from typing import Literal

from mimoc.schema.base import Model

SkinTone = Literal["light", "fair", "medium", "tan", "brown", "dark"]
HairColour = Literal["black", "dark", "brown", "light_brown", "blond", "red"]
EyeColour = Literal["dark", "brown", "hazel", "green", "blue", "grey"]
Clothes = Literal["bodysuit", "shirt_and_trousers", "trousers", "nappy"]

BODYSUIT_UNTIL_MONTHS = 6.0
"""Age from which a shirt and trousers are put on by default (D): children begin to sit and to creep."""


class LooksSpec(Model):
    """What the infant looks like; of its numbers, only those of pictures and skin depend on it."""

    skin: SkinTone = "fair"
    """Tone of the skin, from light to dark; lips, cheeks, ears and folds follow it."""
    hair: HairColour = "brown"
    """Colour of hair and brows."""
    eyes: EyeColour = "blue"
    """Colour of the irises."""
    clothes: Clothes | None = None
    """What the infant wears: a bodysuit, a shirt and trousers, trousers alone or a nappy; by default a bodysuit below 6
    months of corrected age, and a shirt and trousers from then on. A growing infant keeps what it began with."""

    def clothes_at(self, corrected_age_months: float) -> Clothes:
        """Return what an infant of an age wears, counted from term if it was born before.

        Example:
            >>> from mimoc.schema.looks import LooksSpec
            >>> LooksSpec().clothes_at(3), LooksSpec().clothes_at(9), LooksSpec(clothes="nappy").clothes_at(9)
            ('bodysuit', 'shirt_and_trousers', 'nappy')
        """
        by_age: Clothes = "bodysuit" if corrected_age_months < BODYSUIT_UNTIL_MONTHS else "shirt_and_trousers"
        return self.clothes or by_age
