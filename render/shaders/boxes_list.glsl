// Boxes that cover too many pixels for one thread: middling ones first, from `boxCount` on large ones.
layout(std430, binding = 2) buffer Lists {
  uint listed[2];
  uint list[];
};
