"""How provenance is written: what many numbers share once."""

import json

from hypothesis import given, strategies as st

from mimoc.base.rounding import render_json
from mimoc.bundle.provenance import packed, unpacked

words = st.text("ab '*:;,.x1 ", max_size=12)
names = st.text("ab:_", min_size=1, max_size=5)
entries = st.dictionaries(
    names.map("geom.{}.size".format),
    st.fixed_dictionaries(
        {"value": st.integers() | st.lists(st.integers()), "rule": words},
        optional={
            "from": st.lists(names | names.map("geom.{}.mass".format)),
            "xml": names.map("infant.xml: geom[@name='{}']/@size".format),
            "unit": words,
            "fit": st.dictionaries(words, st.integers()),
        },
    ),
)


@given(entries=entries)
def test_what_is_written_is_read_again(entries):
    assert unpacked(json.loads(render_json(packed(entries)))) == entries


def test_shared_phrases_sources_and_places_are_written_once():
    rule = "one factor x 2, by a law; the law says so"
    entries = {
        f"geom.{name}.mass": {
            "value": 1,
            "rule": rule,
            "from": ["spec.age_months", f"geom.{name}.size"],
            "xml": f"geom[@name='{name}']/@mass",
        }
        for name in ("head", "left_foot1", "left_foot2")
    }
    written = packed(entries)
    assert written["phrases"] == ["one factor", "x 2,", "by a law;", "the law says so", "geom[@name='*']/@mass"]
    assert written["sources"] == [("spec.age_months", "geom.*.size")]
    assert len(written["origins"]) == 1
    assert unpacked(written) == entries
