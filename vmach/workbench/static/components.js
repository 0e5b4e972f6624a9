// What the symbols of ISO 230-1 for errors of an axis mean, in words: EXX, EYX, EAX, EC0Y.

export function componentWords(symbol) {
  const squareness = /^E([ABC])0([XYZ])$/.exec(symbol), of = /^E([XYZABC])([XYZ])$/.exec(symbol);
  const about = (turn) => "XYZ"["ABC".indexOf(turn)];
  if (squareness) return `squareness of ${squareness[2]}, about ${about(squareness[1])}`;
  if (!of) return "";
  const [, what, axis] = of;
  if (what === axis) return `positioning of ${axis}`;
  if ("XYZ".includes(what)) return `straightness of ${axis} in ${what}`;
  if (about(what) === axis) return `roll of ${axis}`;
  const [first, second] = { X: "YZ", Y: "XZ", Z: "XY" }[axis] ?? "";
  return `${about(what) === first ? "pitch" : about(what) === second ? "yaw" : "tilt"} of ${axis}, about ${about(what)}`;
}
