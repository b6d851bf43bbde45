"""What MIMo's code looks up in a model, by name or by place: every bundle has it."""


def face_texture(expression: str) -> str:
    """Return the name of the texture that shows an expression; the neutral one is MIMo's default."""
    return f"tex_head_{'default' if expression == 'neutral' else expression}"


def lock_name(joint: str) -> str:
    """Return the name of the constraint that locks a hinge: that of the hinge."""
    return joint
