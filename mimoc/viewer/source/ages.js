// Numbers that change with age: straight lines between the ages that the page has.

export class Ages {
  constructor(months) {
    this.months = months;
  }

  // Between which of the ages an age is, and how far from the first of the two.
  at(age) {
    const last = this.months.length - 1;
    let before = 0;
    while (before < last - 1 && this.months[before + 1] <= age) before += 1;
    const [one, other] = [this.months[before], this.months[before + 1] ?? Infinity];
    return { before, share: Math.min(Math.max((age - one) / (other - one), 0), 1) };
  }

  // The numbers of an array at an age, whose first axis is age; written to `out` if it is given.
  blend({ values, shape, unit }, age, out) {
    const width = values.length / shape[0];
    const { before, share } = this.at(age);
    const found = out ?? new Float32Array(width);
    const one = before * width;
    const other = Math.min(before + 1, shape[0] - 1) * width;
    for (let i = 0; i < width; i += 1) {
      found[i] = unit * (values[one + i] + share * (values[other + i] - values[one + i]));
    }
    return found;
  }
}
