"""Knocks a wall over. The argument is the part of the tutorial to stop at, 1 to 6."""
import sys

import rubble


# 1. A wall of ten levels of bricks.
def wall():
    scene = rubble.Scene()
    for level in range(10):
        for column in range(10):
            position = (0.5 * column + 0.25 * (level % 2), 0, 0.125 + 0.25 * level)
            scene.add_body(rubble.box(0.5, 0.25, 0.25), position=position)  # 1000 kg/m3, friction 0.6
    return scene


# 2. A floor.
def add_floor(scene):
    scene.add_body(rubble.plane())


# 3. A ball that flies at the wall.
def shoot(world):
    world.bodies.add(shape=rubble.sphere(0.4), density=3000, position=(2.5, -3, 1.2), velocity=(0, 15, 2))


# 4. How many bricks have left their place?
def fallen(world, start):
    moved = (world.positions[:100] - start) ** 2
    return int((moved.sum(axis=1) > 0.1**2).sum())


# 5. Mortar: neighbors in a level are glued, until a force of 2000 N parts them.
def add_mortar(scene):
    for brick in range(99):
        if brick % 10 != 9:
            level, column = divmod(brick, 10)
            between = (0.5 * column + 0.25 * (level % 2) + 0.25, 0, 0.125 + 0.25 * level)
            scene.add_joint("fixed", brick, brick + 1, anchor=between, break_force=2000)


def main(part):
    scene = wall()
    if part >= 2:
        add_floor(scene)
    if part >= 5:
        add_mortar(scene)
    world = rubble.World(scene, iterations=4)
    start = world.positions[:100].copy()
    broken = 0
    for step in range(240):
        if part >= 3 and step == 60:
            shoot(world)
        # 6. Without gravity the pieces fly on.
        if part >= 6 and step == 60:
            world.gravity = (0, 0, 0)
        broken += world.step().broken_joints
    text = f"part {part}: the first brick is at {world.body_at(0).position[2]:.1f} m"
    if part >= 4:
        text += f", {fallen(world, start)} of 100 bricks have left their place"
    if part >= 5:
        text += f", {broken} joints broke"
    print(text)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 6)
