"""Specs with something wrong in them, by what that is."""

HEAD = "mimoc: 1\nname: x\nage_months: 9\n"

AGES = ["-1", "24.5", ".nan", ".inf", "1e400", "nine", "'9'", "9 months", "9,5", "true", "[9]", "{months: 9}", ""]

SPECS = {
    # The file and its text.
    "an empty file": "",
    "only a comment": "# nothing yet\n",
    "only the start of a document": "---\n",
    "a list": "- mimoc: 1\n",
    "a word": "infant\n",
    "UTF-16": "mimoc: 1\n".encode("utf-16"),
    "Latin-1": HEAD.encode() + "# Säugling\n".encode("latin-1"),
    "zeros": b"\x00" * 1000,
    "a PNG": b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR",
    "control characters": HEAD + "task: \x1b[31m{kind: reach}\n",
    "a tab for indentation": HEAD + "body:\n\thands: mitten\n",
    "a tab after a value": "mimoc: 1\nname: x\nage_months: 9\t# months\n",
    "a byte order mark and a wrong age": "\ufeffmimoc: 1\nname: x\nage_months: 99\n".encode(),
    "CRLF and a wrong age": b"mimoc: 1\r\nname: x\r\nage_months: 99\r\n",
    "two documents": HEAD + "---\n" + HEAD,
    "an open bracket": HEAD + "body: {remove: [left_hand, right_hand}\n",
    "an open brace": HEAD + "body: {hands: mitten\n",
    "an open quote": HEAD.replace("name: x", "name: 'x"),
    "crooked indentation": HEAD + "body:\n    hands: mitten\n  expression: happy\n",
    "a colon too many": HEAD.replace("name: x", "name: x: y"),
    "no colon": HEAD + "task\n",
    "a value that starts with @": HEAD.replace("name: x", "name: @x"),
    "an unknown escape": HEAD.replace("name: x", r'name: "\q"'),
    "an escape that is no character": HEAD.replace("name: x", r'name: "\UFFFFFFFF"'),
    "an escape that is no text": HEAD.replace("name: x", r'name: "\0"'),
    "deep nesting": HEAD + "body: " + "[" * 100 + "\n",
    "deep nesting of a key": HEAD + "? " + "[" * 100 + "]" * 100 + "\n: 1\n",
    "an alias bomb": "a: &a [x,x,x,x,x,x,x,x]\n"
    + "".join(f"{b}: &{b} [{','.join([f'*{a}'] * 8)}]\n" for a, b in zip("abcdefg", "bcdefgh", strict=True)),
    "an alias of nothing": HEAD + "body: *usual\n",
    "an alias inside itself": HEAD + "body: &body {parts: *body}\n",
    "a tag that would run code": HEAD + "body: !!python/object/apply:os.system ['true']\n",
    "tags": "mimoc: !!int 1\nname: !my x\nage_months: !!float 9\n",
    "merge keys": HEAD + "body: &usual {hands: mitten}\nscene:\n  <<: *usual\n",
    "keys that are no words": HEAD + "1: a\n[b]: c\ntrue: e\nno: f\n",
    "repeated keys": HEAD + "age_months: 10\nbody:\n  hands: mitten\n  hands: five_finger\n",
    # Versions, names, ages.
    "nothing that is needed": "body: {}\n",
    "a newer language": HEAD.replace("mimoc: 1", "mimoc: 2"),
    "the version as text": HEAD.replace("mimoc: 1", "mimoc: '1'"),
    "a name with capitals": HEAD.replace("name: x", "name: Nine Months"),
    "a name that is a number": HEAD.replace("name: x", "name: 9"),
    "a name that starts with a digit": HEAD.replace("name: x", "name: 9_months"),
    "a long name": HEAD.replace("name: x", f"name: {'x' * 100}"),
    **{f"an age of {age or 'nothing'}": f"mimoc: 1\nname: x\nage_months: {age}\n" for age in AGES},
    # Keys.
    "unknown keys at every level": HEAD
    + "sense: {}\nbody: {hand: mitten, individual: {gender: male}, parts: {left_hand: {lenght: 1}}}\n"
    + "actuation: {kind: torque}\nsenses: {vestibular: {noise: 1}, touch: {densty: 1}, vision: {acuity: {cpm: 1}}}\n"
    + "delays: {motors_ms: 5}\nscene: {room: {dimensions: 1}, toys: {number: 3}}\n"
    + "control: {frame_skip: 2}\ntask: {reward: sparse}\n",
    "keys without their unit or in another": HEAD.replace("age_months", "age")
    + "body:\n  individual: {sex: male, length_m: 0.7, weight_g: 7400}\n"
    + "  measurements: {foot_length: 11, hand_length_mm: 9}\n"
    + "senses: {vision: {fovy: 60, width: 64, height_pixels: 64}}\n"
    + "delays: {vision: 10, motor_s: 0.005}\nscene: {room: {size: 1}, toys: {size_mm: [4, 12]}}\n"
    + "control: {timestep: 5, step_s: 0.01}\n",
    "keys in the wrong section": HEAD + "hands: mitten\nseed: 3\nfovy_deg: 60\nkind: flat\nscene: {name: x}\n",
    "keys in another spelling": HEAD.replace("name", "Name") + "senses: {vision: {Width-px: 64}}\n",
    # Values.
    "wrong types": HEAD
    + "body: {chest_joint: yes, individual: 50, measurements: [9], parts: {left_hand: 0.9}, remove: left_hand}\n"
    + "actuation: strong\nsenses: [vision]\ndelays: 50\nscene: {seed: 1.5, toys: {root: 4, subset: [1], count: 3}}\n"
    + "control: {step_ms: fast}\ntask: reach\n",
    "numbers with units": HEAD
    + "senses: {vision: {fovy_deg: 60 deg, width_px: 64px}}\ndelays: {motor_ms: 10ms}\n"
    + "scene: {toys: {size_cm: [4 cm, 0.1 m]}}\n",
    "values left empty": HEAD + "body:\n  hands:\nsenses:\n  touch:\n  vision: ~\nbody_2: null\n",
    "wrong choices": HEAD
    + "body: {hands: mittens, expression: joyful}\nactuation: {model: muscles}\n"
    + "senses: {proprioception: {include: [speed, torque]}, touch: {quantity: 3}, vision: {acuity: of}}\n"
    + "delays: {preset: Paper}\nscene: {kind: nursery, pose: sit}\ntask: {kind: reech}\n",
    "looks that there are not": HEAD
    + "body: {looks: {skin: dusky, hair: blonde, eyes: gray, clothes: [shirt], shoes: red}}\nlooks: {skin: dark}\n",
    "numbers out of range": HEAD
    + "body: {individual: {sex: male, length_percentile: 0, weight_kg: 74}, measurements: {foot_length_cm: 0},"
    + " parts: {head: {girth: 3}}}\n"
    + "actuation: {strength_age_months: 25, strength: {legs: -1}}\n"
    + "senses: {vision: {width_px: 0, fovy_deg: 180, acuity: 48}, touch: {density: 0}}\n"
    + "delays: {motor_ms: -5}\nscene: {seed: -1, toys: {count: [0, 51]}}\ncontrol: {timestep_ms: 0}\n",
    "an acuity that is none": HEAD + "senses: {vision: {acuity: true}}\n",
    "eyes of no age": HEAD + "senses: {vision: {contrast: agee, colour: 40, field: true, focus: [1], flicker: 3 Hz}}\n",
    "an acuity without its number": HEAD + "senses: {vision: {acuity: {}}}\n",
    "ranges": HEAD + "scene: {room: {size_m: [[5, 2.5], [2.5, 5]]}, toys: {count: [3], size_cm: [12, 4]}}\n",
    "ranges of rooms": HEAD + "scene: {room: {size_m: [2.5, 2.5, 2.2]}}\n",
    "names twice": HEAD + "body: {remove: [left_hand, left_hand]}\nscene: {toys: {subset: [ball, cup, ball]}}\n",
    "a toy without a name": HEAD + "scene: {toys: {subset: ['']}}\n",
    # Keys against each other.
    "a girl and percentiles in words": HEAD
    + "body: {individual: {sex: girl, length_percentile: P10, weight_percentile: 25th, head_percentile: 50 %}}\n",
    "percentiles of nobody": HEAD
    + "body: {individual: {sex: male, length_percentile: 5e-324, weight_percentile: 99.99999999999999}}\n",
    "two lengths": HEAD + "body: {individual: {sex: male, length_percentile: 50, length_cm: 70}}\n",
    "a percentile of no sex": HEAD + "body:\n  individual:\n    length_percentile: 50\n",
    "an individual of whom nothing is known": HEAD + "body: {individual: {sex: male}}\n",
    "Toys4K from nowhere": HEAD + "scene: {toys: {source: toys4k}}\n",
    "a measurement of no table": HEAD + "body: {measurements: {nose_length_cm: 2, foot_lenght_cm: 11}}\n",
    "one side of the trunk": HEAD + "body: {measurements: {left_head_circumference_cm: 40}}\n",
    "a group of no muscles": HEAD + "actuation: {strength: {left_arms: 0.5}}\n",
    "groups that take commands and are locked": HEAD + "actuation: {regions: [arms, neck], locked: [left_arm, legs]}\n",
    "groups of no muscles": HEAD
    + "actuation: {regions: [arm], locked: [head]}\nsenses: {touch: {regions: [skin, legs, legs]}}\n",
    "skin nowhere": HEAD + "senses: {touch: {regions: []}}\n",
    "no part to hold": HEAD + "scene: {held: [chests, chest, chest]}\n",
    "choices of another task": HEAD + "task: {kind: standup, hand: left, reward: shaped}\n",
    "a task without its kind": HEAD + "task: {steps: 100}\n",
    "numbers of a task": HEAD + "task: {kind: reach, steps: 0, hand: both}\n",
    "standing up in a crib": HEAD + "scene: {kind: crib}\ntask: {kind: standup}\n",
    "turning over in nothing": HEAD + "scene: {kind: empty}\ntask: {kind: rollover}\n",
    "turning over from sitting": HEAD + "scene: {pose: sitting}\ntask: {kind: rollover}\n",
    "an infant without a head": HEAD + "body: {remove: [head, hip, left_elbow]}\n",
    "a part of no body": HEAD + "body: {parts: {left_forearm: {length: 1}}}\n",
    "fingers of a mitten": HEAD + "body: {remove: [left_thdistal], parts: {left_lfmiddle: {girth: 1}}}\n",
    "delays between physics steps": HEAD
    + "senses: {touch: {}, vision: {}}\ndelays: {vision_ms: 12, touch_ms: 3}\ncontrol: {timestep_ms: 2.5}\n",
    "delays of senses that are off": HEAD + "delays: {vision_ms: 12, touch_ms: 5}\n",
    "noise out of range": HEAD + "noise: {motor: 1.2, proprioception_deg: -1, touch_n: 101, delay_jitter_ms: 2000}\n",
    "noise in words": HEAD + "noise: {motor: 10 %, touch: 1, proprioception_rad: 0.1, vision: 3, jitter_ms: 5}\n",
    "motor noise in other forms": HEAD + "noise: {motor: [0.1]}\n",
    "motor noise of another word": HEAD + "noise: {motor: mature}\n",
    "noise of a sense that is off": HEAD + "noise: {touch_n: 0.05}\n",
    "noise in proportion to angles": HEAD + "actuation: {model: position}\nnoise: {motor: 0.1}\n",
    "jitter between physics steps": HEAD + "delays: {motor_ms: 10}\nnoise: {delay_jitter_ms: 7}\n",
    "jitter of no delay": HEAD + "noise: {delay_jitter_ms: 5}\n",
    "jitter of delays of senses that are off": HEAD + "delays: {vision_ms: 100}\nnoise: {delay_jitter_ms: 5}\n",
    "skin points of parts without skin": HEAD + "senses: {touch: {regions: [trunk], spacing_cm: {head: 0.5}}}\n",
    "skin points of parts on removed ones": HEAD
    + "body: {remove: [left_lower_arm]}\nsenses: {touch: {spacing_cm: {left_hand: 1}}}\n",
    "gaps to nothing": HEAD
    + "scene:\n  objects:\n  - {name: cup, at: {x_cm: 30}, distance_cm: 5}\n"
    + "  - {name: ball, above: head, distance_cm: 5}\n"
    + "  - {name: box, at: on cup, distance_cm: 5}\n  - {name: rod, distance_cm: 5}\n",
    "more objects than there can be": HEAD + f"scene: {{objects: [{', '.join(['{name: x}'] * 51)}]}}\n",
    "more answers than there can be": HEAD
    + "scene: {caregiver: {answers: {by: [smile, smile, smile, smile, smile, smile]}}}\n",
    "fewer figures than there can be": HEAD + "scene: {objects: [{name: m, kind: mobile, figures: [fish]}]}\n",
    "a caregiver that cannot be": HEAD
    + "scene:\n  kind: crib\n  caregiver: {place: in front, distance_cm: 5, expression: bored, mood: good}\n",
    "a caregiver in a crib": HEAD + "scene: {kind: crib, caregiver: {}}\n",
    "acts of a caregiver that cannot be": HEAD
    + "scene:\n  caregiver:\n    script:\n    - {at_s: 2, do: sing}\n    - {do: speak, pitch_hz: 5, level: 60}\n",
    "an offer of nothing": HEAD + "scene: {caregiver: {script: [{do: offer}]}}\n",
    "an offer of what is not there": HEAD + "scene: {caregiver: {script: [{do: offer, object: ball}]}}\n",
    "a look with a pitch": HEAD + "scene: {caregiver: {script: [{do: look_at, pitch_hz: 300}]}}\n",
    "an act on a finger of a mitten": HEAD + "scene: {caregiver: {script: [{do: hold, part: left_thdistal}]}}\n",
    "an act that takes no time": HEAD + "scene: {caregiver: {script: [{do: look_at, duration_ms: 0}]}}\n",
    "acts out of order": HEAD + "scene: {caregiver: {script: [{at_s: 2, do: look_at}, {at_s: 1, do: look_away}]}}\n",
    "an answer between physics steps": HEAD + "scene: {caregiver: {answers: {delay_ms: 402}}}\n",
    "an answer that takes hands": HEAD + "scene: {caregiver: {answers: {by: [hold], probability: 2}}}\n",
    "a control step between physics steps": HEAD + "control: {step_ms: 12}\n",
    "a control step shorter than physics": HEAD + "control: {step_ms: 2}\n",
    "a physics step that does not fit": HEAD + "control: {timestep_ms: 3}\n",
    "problems of all kinds": "mimoc: 1\nname: Nine\nage_months: .nan\nbody:\n  hands: miten\n  hands: mitten\n"
    + "senses:\n  vision: {fovy: 60, acuity: !!str off}\ndelays: {vision_ms: 7}\ntask: {kind: reech}\n",
}
