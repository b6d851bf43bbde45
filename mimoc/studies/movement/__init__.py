"""Movement: whether an infant kicks, swings, lifts, folds, looks, grips and steps as real infants do."""
