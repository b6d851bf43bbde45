"""What the experiments on kicks and steps share: infants and what is tied to them, drives, measures, trials by seed."""
