"""The body: from measurements to a body tree with masses, joints and strengths."""
