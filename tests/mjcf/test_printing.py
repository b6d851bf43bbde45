import pytest
from jinja2 import UndefinedError

from mimoc.mjcf.printing import environment, render_text


def test_a_template_that_is_given_too_little_fails():
    with pytest.raises(UndefinedError):
        environment().from_string("{{ nothing }}").render()
    with pytest.raises(UndefinedError, match="manifest"):
        render_text("README.md.j2", version="1")


def test_names_are_escaped_in_xml():
    template = environment().get_template("scene.xml.j2")
    assert template.environment.autoescape("scene.xml.j2")
    assert not template.environment.autoescape("README.md.j2")
