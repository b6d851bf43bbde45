"""What a spec says of noise is in its manifest, and explained."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

import mimoc
from mimoc.base.errors import SpecError
from mimoc.compiler.explain import entries_of
from mimoc.compiler.presets import motor_share, noise
from mimoc.schema.senses import DelaysSpec, NoiseEntry, NoiseSpec, is_delayed, noise_keys
from mimoc.schema.source import parse

BASE = {"mimoc": 1, "name": "x", "age_months": 9}
ALL = {
    "motor": 0.1,
    "proprioception_deg": 1.0,
    "vestibular_thresholds": 2.0,
    "touch_n": 0.05,
    "hearing_db": 2.0,
    "delay_jitter_ms": 5.0,
}
NOISY = {
    **BASE,
    "senses": {"proprioception": {}, "vestibular": {}, "touch": {"density": 0.1}, "hearing": {}},
    "delays": {"preset": "physiological"},
    "noise": ALL,
}


def test_all_noise_is_off_by_default():
    spec = mimoc.InfantSpec.model_validate(BASE)
    assert noise(spec, ["robot:left_elbow"]) == NoiseEntry()
    assert set(NoiseEntry().model_dump().values()) == {0.0, 60.0}


def test_the_manifest_has_what_the_spec_says():
    assert mimoc.build(mimoc.InfantSpec.model_validate(NOISY)).manifest.noise == NoiseEntry(**ALL)


def test_the_spec_and_the_manifest_have_the_same_keys():
    of_entries = {"low_pass_ms", "of_commands", "proprioception_low_pass_ms"}
    assert NoiseSpec.model_fields.keys() == NoiseEntry.model_fields.keys() - of_entries == ALL.keys()
    assert set(noise_keys().values()) < ALL.keys()


def test_every_noise_is_led_back_to_its_key():
    found = entries_of(mimoc.build(mimoc.InfantSpec.model_validate(NOISY)))
    for key, value in ALL.items():
        assert found[f"noise.{key}"]["value"] == value
        assert found[f"noise.{key}"]["from"] == [f"spec.noise.{key}"]
        assert found[f"spec.noise.{key}"]["value"] == value
    assert found["noise.low_pass_ms"]["value"] == 60


@given(st.floats(0, 24), st.floats(0, 24))
def test_maturing_motor_noise_falls_from_30_to_10_percent(one, other):
    young, old = (
        noise(mimoc.InfantSpec.model_validate({**BASE, "age_months": age, "noise": {"motor": "maturing"}}), []).motor
        for age in sorted((one, other))
    )
    assert 0.1 <= old <= young <= 0.3 + 1e-12
    assert motor_share(0) == pytest.approx(0.3)
    assert motor_share(18) == motor_share(24) == 0.1


def test_maturing_motor_noise_is_explained():
    spec = mimoc.InfantSpec.model_validate({**BASE, "noise": {"motor": "maturing"}})
    entry = entries_of(mimoc.build(spec))["noise.motor"]
    assert entry["from"] == ["spec.noise.motor", "spec.age_months"]
    assert entry["value"] == pytest.approx(0.1 + 0.2 * (np.exp(-9 / 8) - np.exp(-18 / 8)) / (1 - np.exp(-18 / 8)))


@given(
    st.sampled_from(["none", "paper", "physiological"]),
    st.dictionaries(st.sampled_from(["sensory_ms", "touch_ms", "motor_ms"]), st.sampled_from([0.0, 5.0])),
)
def test_jitter_needs_a_delay_of_the_commands_or_of_a_sense_that_is_on(preset, given_ms):
    """As the manifest has them: the preset counts where no key says otherwise."""
    delays = {"preset": preset, **given_ms}
    spec = {**BASE, "senses": {"touch": {}}, "delays": delays, "noise": {"delay_jitter_ms": 5.0}}
    touch_ms = given_ms.get("touch_ms", given_ms.get("sensory_ms", 5.0 * (preset != "none")))
    late = bool(touch_ms or given_ms.get("motor_ms", 5.0 * (preset != "none")))
    assert is_delayed(DelaysSpec(**delays), ["touch"]) == late
    if late:
        mimoc.InfantSpec.model_validate(spec)
    else:
        with pytest.raises(SpecError, match="no delay varies"):
            mimoc.InfantSpec.model_validate(spec)


@pytest.mark.parametrize("zero", [0, 0.0])
def test_a_noise_of_zero_needs_nothing(zero):
    text = (
        f"mimoc: 1\nname: x\nage_months: 9\nactuation: {{model: position}}\nnoise: {{motor: {zero}, touch_n: {zero}}}\n"
    )
    assert mimoc.schema.read_spec(parse(text, "f")).noise == NoiseSpec()


def test_a_bad_noise_writes_nothing(invoke, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.yaml").write_text("mimoc: 1\nname: x\nage_months: 9\nnoise: {motor: 3}\n")
    message = "a.yaml:4:16: noise.motor: 3 is too large; give 0 to 1\n"
    assert invoke("build", "a.yaml", "-o", "out") == (2, "", message)
    assert [path.name for path in tmp_path.iterdir()] == ["a.yaml"]


def problems(text: str) -> list[str]:
    with pytest.raises(SpecError) as caught:
        mimoc.schema.read_spec(parse(f"mimoc: 1\nname: x\nage_months: 9\n{text}\n", "f"))
    return [f"{problem.line}:{problem.column} {problem.key}" for problem in caught.value.problems]


def test_every_noise_that_has_nothing_to_act_on_is_reported_at_once_with_its_place():
    assert problems(
        "actuation: {model: position}\n"
        "noise: {motor: 0.1, touch_n: 0.1, proprioception_deg: 1,\n"
        "        delay_jitter_ms: 5}"
    ) == ["5:16 noise.motor", "5:30 noise.touch_n", "5:55 noise.proprioception_deg", "6:26 noise.delay_jitter_ms"]


@pytest.mark.parametrize(
    ("wrong", "noise"),
    [
        ("senses: {touch: 3}", "touch_n: 0.1"),
        ("delays: {motor_ms: 3.3}", "delay_jitter_ms: 5"),
        ("actuation: {model: lever}", "motor: 0.1"),
    ],
)
def test_what_noise_acts_on_is_not_said_to_be_missing_when_it_is_wrong(wrong, noise):
    assert len(problems(f"{wrong}\nnoise: {{{noise}}}")) == 1


def test_a_changed_spec_is_checked_too():
    with pytest.raises(SpecError, match="'touch' is off"):
        mimoc.InfantSpec.model_validate(NOISY).with_(senses={"touch": None})
