import pytest
from jinja2 import Environment, FileSystemLoader, UndefinedError

from mimoc.compiler.mjcf.printing import TEMPLATES, CompiledTemplates, environment, render_text


def test_a_template_that_is_given_too_little_fails():
    with pytest.raises(UndefinedError):
        environment().from_string("{{ nothing }}").render()
    with pytest.raises(UndefinedError, match="manifest"):
        render_text("README.md.j2", version="1")


def test_names_are_escaped_in_xml():
    template = environment().get_template("scene.xml.j2")
    assert template.environment.autoescape("scene.xml.j2")
    assert not template.environment.autoescape("README.md.j2")


@pytest.fixture
def compiles(monkeypatch):
    """Return whether an environment that keeps compiled templates in a folder compiles one of mimoc's templates."""

    def _compiles(folder):
        compiled = []
        new = Environment(loader=FileSystemLoader(TEMPLATES), bytecode_cache=CompiledTemplates(str(folder)))
        new.filters["num"] = str
        original = new.compile
        monkeypatch.setattr(new, "compile", lambda *args, **kwargs: compiled.append(args) or original(*args, **kwargs))
        assert new.get_template("README.md.j2")
        return bool(compiled)

    return _compiles


def test_a_template_is_compiled_once_for_all_processes(compiles, tmp_path):
    assert [compiles(tmp_path / "new"), compiles(tmp_path / "new")] == [True, False]


@pytest.mark.parametrize("content", [b"", b"damaged", b"j2\x05\x00\x00\x00\x00\x00"])
def test_a_damaged_compiled_template_is_compiled_again(compiles, tmp_path, content):
    compiles(tmp_path)
    for file in tmp_path.iterdir():
        file.write_bytes(content or file.read_bytes()[:40])
    assert [compiles(tmp_path), compiles(tmp_path)] == [True, False]


def test_a_folder_that_cannot_be_made_costs_only_time(compiles, tmp_path):
    (tmp_path / "file").touch()
    assert [compiles(tmp_path / "file" / "below"), compiles(tmp_path / "file")] == [True, True]
