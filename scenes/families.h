#pragma once
/// The scene families that the registry is made of, one function a file.
#include <vector>

#include "registry.h"

namespace rubble::scenes {

std::vector<Spec> bounceSpecs();         ///< restitution: a ladder of bounces, Newton's cradle
std::vector<Spec> basicSpecs();          ///< closed forms: fall, projectile, pendulum, spin, impact
std::vector<Spec> pileSpecs();           ///< bonded blocks of bricks, 40 levels
std::vector<Spec> wallSpecs();           ///< running-bond walls, the ring wall, gables
std::vector<Spec> pyramidSpecs();        ///< pyramids of unit cubes
std::vector<Spec> towerSpecs();          ///< columns: equal cubes, heavy on light, growing cubes
std::vector<Spec> chainSpecs();          ///< hanging and swinging chains with a heavy end
std::vector<Spec> ropeSpecs();           ///< ropes of bricks, a bridge, a joint grid
std::vector<Spec> frictionSpecs();       ///< sliding and rolling
std::vector<Spec> frictionLimitSpecs();  ///< where sticking and standing end
std::vector<Spec> siloSpecs();           ///< grains in a tall bin
std::vector<Spec> rollingSpecs();        ///< rolling without slip
std::vector<Spec> fineStackSpecs();      ///< stacks that inaccurate solutions let fall
std::vector<Spec> jengaSpecs();          ///< a tower out of which blocks are drawn
std::vector<Spec> structureSpecs();      ///< card tower, dominoes, arch, breakable beam
std::vector<Spec> softSolidSpecs();      ///< solids of tetrahedra
std::vector<Spec> softSheetSpecs();      ///< cloth, nets, ropes
std::vector<Spec> softContactSpecs();    ///< surfaces that touch themselves and one another
std::vector<Spec> softDentSpecs();       ///< small bodies on coarse cloth
std::vector<Spec> softClaySpecs();       ///< solids that yield
std::vector<Spec> rodSpecs();            ///< rods of oriented segments
std::vector<Spec> softPressureSpecs();   ///< closed sheets under pressure
std::vector<Spec> softMachineSpecs();    ///< deformable objects in machines and among bodies
std::vector<Spec> softPlateSpecs();      ///< many jointed bodies on cloth
std::vector<Spec> softGrainSpecs();      ///< granular particles
std::vector<Spec> mixedSpecs();          ///< jointed bodies and deformables together
std::vector<Spec> softStringSpecs();     ///< strings in closed form
std::vector<Spec> shapeRestSpecs();      ///< shapes at rest: an arch of wedges, a drop of every kind, a bowl
std::vector<Spec> shapeMotionSpecs();    ///< shapes in motion: a marble run, a tumbler, conveyors
std::vector<Spec> fastSpecs();           ///< bullets against plates
std::vector<Spec> bodySpecs();           ///< damping, locked axes, layers, sensors, sleep
std::vector<Spec> removalSpecs();        ///< stacks whose support goes
std::vector<Spec> scaleSpecs();          ///< joints by the ten thousand
std::vector<Spec> jointAxisSpecs();  ///< hinges, springs, motors, ropes, breakage, drag: one axis at a time
std::vector<Spec> machineSpecs();    ///< crank, gears, rack, pulley, universal shaft, platform
std::vector<Spec> gearSpecs();       ///< gears and racks whose axes move
std::vector<Spec> topSpecs();        ///< fast tops
std::vector<Spec> robotSpecs();      ///< robot arm, car
std::vector<Spec> ragdollSpecs();    ///< ragdolls and their limbs
std::vector<Spec> cableSpecs();      ///< mail, suspension bridge, trebuchet, wrecking ball
std::vector<Spec> paperSpecs();      ///< balls on a chain and a breakable wall, of the AVBD paper
std::vector<Spec> driverSpecs();     ///< a character and a vehicle with somebody at the controls
std::vector<Spec> springSpecs();     ///< springs of avbd-demo3d

}  // namespace rubble::scenes
