"""Which body can learn which skill at which age: searches for movements, by age, beside the ages of real infants."""
