/// Actuators in a world: the laws of their forces, and what their controls move.
#include <gtest/gtest.h>

#include <cmath>

#include <rubble/actuators.h>

#include "tests/support/expect.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

using test::options;

/// A muscle, its state, and what mju_muscleGain, mju_muscleBias and mju_muscleDynamics of MuJoCo 4 make of
/// it.
struct MuscleCase {
  double length, speed;                                     ///< of the actuator [m], [m/s]
  double peakForce, optimalLength, tendonLength;            ///< [N], [m]
  double shortest, longest, fastest, passive, lengthening;  ///< of rubble::Muscle
  double gain, bias;                                        ///< [N]
  double control, activation;                               ///< [1]
  double rise, fall, smoothing;                             ///< [s], [s], [1]
  double rate;                                              ///< of the activation [1/s]
};
const MuscleCase kMuscles[] = {
    {0.2389281244, -0.09170411004, 175.7371719, 0.829704499, -0.5323360562, 0.6712844092, 1.342252346,
     1.474824537, 1.92249268, 1.473130156, -136.5747672, 0.0, 0.9032554323, 0.6703605841, 0.03482793286,
     0.04202470526, 0.5, 4.442391609},
    {0.5774008023, 0.9322693559, 223.8330421, 0.4992420177, -0.1811740085, 0.5214921451, 1.590174818,
     2.637029246, 1.387392956, 1.241180739, -7.978733962, -391.3903422, 0.1880028495, 0.08311699774,
     0.01079418521, 0.05736585654, 0.0, 15.55509162},
    {0.4159907812, 0.2177000526, 221.8836236, 0.2822623613, 0.1161798184, 0.6605724315, 1.430288954,
     0.9719883744, 0.8011534312, 1.307448724, -277.9888266, -7.422148318, 0.02375317175, 0.9964358755,
     0.03638124899, 0.04714565286, 0.5, -41.15258028},
    {0.1317038719, 0.9396062831, 769.0065905, 0.5935175541, -0.1448083637, 0.5351527763, 1.485225846,
     2.450358519, 0.6338558816, 1.203601761, -0.0, 0.0, 0.8349456236, 0.1956528299, 0.02598364387,
     0.03017623328, 0.0, 31.00731651},
    {0.1486375483, 1.028257703, 734.3655914, 1.701514938, -1.394935488, 0.3760680067, 1.355740853,
     0.8934025854, 0.9394626005, 1.536267046, -1078.240603, 0.0, 1.169621592, 0.9410059947, 0.01477450866,
     0.04521461977, 0.2, 2.110106841},
    {0.2641521225, 0.1594321979, 84.01113717, 0.3010965051, -0.05323292523, 0.3269755732, 1.542422552,
     2.074489066, 1.767837473, 1.545084258, -114.5321633, -2.954518748, 1.098503636, 0.1497351738,
     0.0361525598, 0.08248438587, 0.0, 32.45750824},
    {0.2022815322, -0.2782101955, 810.4931246, 0.1573412154, 0.09997282736, 0.6036912616, 1.321244922,
     2.668942797, 0.7445852486, 1.699281493, -2.546559205, 0.0, 0.6909059906, 0.15974824, 0.02107488708,
     0.02487093623, 0.2, 34.07597059},
    {0.1880257244, -0.8354408398, 82.84309294, 0.2226251583, 0.008846771542, 0.3460950015, 1.633157574,
     4.112299177, 0.9872009707, 1.486071458, -0.5206826908, 0.0, 1.077694369, 0.1156603737, 0.01918446269,
     0.0516214581, 0.5, 68.44440185},
    {-0.2237406332, 1.267851404, 645.2074491, 0.516235628, -0.3855119138, 0.3267002987, 1.783840855,
     4.353548634, 0.7158953589, 1.378966236, -0.0, 0.0, 0.1741606077, 0.7897405145, 0.03733853977,
     0.08437024799, 0.5, -12.29121126},
    {0.262284789, -0.2078557034, 292.9488255, 0.1809705591, -0.006452259112, 0.5423131618, 1.661502238,
     2.047051823, 1.433851232, 1.314351751, -8.037932739, -405.8847527, 0.5745363282, 0.6733463217,
     0.0409457043, 0.05320883847, 0.5, -2.491561529},
    {0.3965398324, 1.202875531, 326.1851247, 0.9556610679, -0.6726189312, 0.5196449192, 1.317220283,
     1.605548048, 1.698896628, 1.570288629, -368.6168285, -155.3479424, 0.2761153101, 0.7498444329,
     0.03899855315, 0.04390275736, 0.2, -17.53191202},
    {0.2512391824, 0.4511692127, 682.9769283, 0.2435154111, -0.06093155482, 0.5238391658, 1.769764971,
     3.128941661, 1.348689561, 1.137538269, -568.4722686, -247.1310438, 0.4945387675, 0.8813351361,
     0.03674954857, 0.08425217563, 0.2, -8.364698292},
};

TEST(Muscle, HasTheForcesAndTheActivationOfMujoco) {
  for (const MuscleCase& c : kMuscles) {
    const Muscle muscle{c.peakForce, c.optimalLength, c.tendonLength, c.shortest, c.longest,  c.fastest,
                        c.passive,   c.lengthening,   c.rise,         c.fall,     c.smoothing};
    const double tolerance = 1e-7 * c.peakForce;
    EXPECT_NEAR(muscle.activeForce(c.length, c.speed), c.gain, tolerance) << c.length;
    EXPECT_NEAR(muscle.passiveForce(c.length), c.bias, tolerance) << c.length;
    EXPECT_NEAR(muscle.activationRate(c.control, c.activation), c.rate, 1e-6 * (1 + std::fabs(c.rate)));
  }
}

/// A cube of 1 kg on a slider along x, without gravity.
Scene sliding(const JointAxis& axis = {}) {
  Scene scene = test::emptyScene({0, 0, 0});
  scene.bodies.push_back(test::unitCube({0, 0, 0}));
  scene.joints.push_back(jointAt(scene, JointType::Slider, 0, kWorld, {0, 0, 0}));
  scene.joints[0].axes[0] = axis;
  return scene;
}

ActuatorDef onSlider(ActuatorType type) {
  ActuatorDef out;
  out.type = type, out.joint = 0;
  return out;
}

double speedAfter(World& world, Actuators& actuators, int steps) {
  for (int i = 0; i < steps; ++i) actuators.apply(world), world.step();
  return world.state(world.bodies()[0]).velocity.x;
}

TEST(Actuators, AForceActsByItsGearWithinItsBounds) {
  World world(sliding(), options(8, "reference"));
  ActuatorDef motor = onSlider(ActuatorType::Force);
  motor.gear = -2, motor.gain = {3, 0, 0}, motor.maxForce = 5, motor.maxControl = 2;
  Actuators actuators({motor}, world);
  actuators.controls()[0] = 1;
  const double dt = world.params().dt;
  EXPECT_NEAR(speedAfter(world, actuators, 10), -6 * 10 * dt, 1e-6);
  actuators.controls()[0] = 4;  // clamped to 2, and the force to 5
  EXPECT_NEAR(speedAfter(world, actuators, 10), -16 * 10 * dt, 1e-6);
  EXPECT_DOUBLE_EQ(actuators.forces()[0], 5);
}

TEST(Actuators, AForceThatResistsMotionIsStableAtAnyStrength) {
  World world(sliding(), options(8, "reference"));
  ActuatorDef damper = onSlider(ActuatorType::Force);
  damper.gain = {0, 0, -1}, damper.control = 1e4;
  Actuators actuators({damper}, world);
  world.setVelocity(world.bodies()[0], {1, 0, 0}, {});
  const double one = speedAfter(world, actuators, 1);
  EXPECT_NEAR(one, 1 / (1 + 1e4 * world.params().dt), 1e-4);
  EXPECT_LT(std::fabs(speedAfter(world, actuators, 10)), one);
}

TEST(Actuators, ControlsMoveTheTargetThatTheDriveHasAtTheBeginning) {
  JointAxis axis;
  axis.driveStiffness = 400, axis.driveDamping = 40, axis.targetPosition = 0.5;
  World world(sliding(axis), options(8, "reference"));
  ActuatorDef servo = onSlider(ActuatorType::Position);
  servo.gain = {0.1, 0, 0}, servo.control = 2, servo.included = 0.2;
  Actuators actuators({servo, servo}, world);
  speedAfter(world, actuators, 300);
  EXPECT_NEAR(world.state(world.joints()[0]).axes[0].position, 0.5, 1e-5);
  actuators.controls()[0] = 3, actuators.controls()[1] = -2;
  speedAfter(world, actuators, 300);
  EXPECT_NEAR(world.state(world.joints()[0]).axes[0].position, 0.5 + 0.1 - 0.4, 1e-5);
}

TEST(Actuators, ActivationsFollowTheirControls) {
  World world(sliding(), options(8, "reference"));
  const double dt = world.params().dt, time = 0.1;
  ActuatorDef filter = onSlider(ActuatorType::Force);
  filter.timeConstant = time, filter.control = 1, filter.gain = {};
  ActuatorDef exact = filter, integrator = filter;
  filter.dynamics = ActuatorDynamics::Filter, exact.dynamics = ActuatorDynamics::FilterExact;
  integrator.dynamics = ActuatorDynamics::Integrator, integrator.maxActivation = 5 * dt;
  integrator.early = true, integrator.gain = {1, 0, 0};
  Actuators actuators({filter, exact, integrator}, world);
  for (int step = 1; step <= 8; ++step) {
    actuators.apply(world);
    EXPECT_NEAR(actuators.activations()[0], 1 - std::pow(1 - dt / time, step), 1e-12);
    EXPECT_NEAR(actuators.activations()[1], -std::expm1(-step * dt / time), 1e-12);
    EXPECT_NEAR(actuators.activations()[2], std::min(step, 5) * dt, 1e-12);
    EXPECT_NEAR(actuators.forces()[2], actuators.activations()[2], 1e-12);
  }
}

TEST(Actuators, AWrenchTurnsWithItsBody) {
  Scene scene = test::emptyScene({0, 0, 0});
  scene.bodies.push_back(test::unitCube({0, 0, 0}));
  scene.bodies[0].orientation = fromAxisAngle(Vec3{0, 0, 1}, std::acos(-1.) / 2);
  World world(scene, options(8, "reference"));
  ActuatorDef rotor;
  rotor.type = ActuatorType::Wrench, rotor.body = 0, rotor.force = {2, 0, 0}, rotor.control = 3;
  Actuators actuators({rotor}, world);
  actuators.apply(world), world.step();
  EXPECT_NEAR(world.state(world.bodies()[0]).velocity.y, 6 * world.params().dt, 1e-7);
}

TEST(Actuators, AdhesionHoldsABodyThatIsLighterThanItsPull) {
  const auto heightAfter = [](double pull) {
    Scene scene = test::emptyScene({0, 0, -10});
    scene.bodies.push_back(test::unitCube({0, 0, 2}));
    scene.bodies[0].motion = Motion::Static;
    scene.bodies.push_back(test::unitCube({0, 0, 1.001}));
    World world(scene, options(4));
    ActuatorDef suction;
    suction.type = ActuatorType::Adhesion, suction.body = 1, suction.control = pull;
    Actuators actuators({suction}, world);
    for (int i = 0; i < 60; ++i) actuators.apply(world), world.step();
    return world.state(world.bodies()[1]).position.z;
  };
  EXPECT_NEAR(heightAfter(12), 1, 2e-3);
  EXPECT_LT(heightAfter(8), 0.5);
}

TEST(Actuators, ErrorsNameWhatIsWrong) {
  const auto messageOf = [](const ActuatorDef& actuator) {
    World world(sliding(), options());
    try {
      Actuators({actuator}, world);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  ActuatorDef actuator = onSlider(ActuatorType::Force);
  actuator.joint = 1;
  EXPECT_NE(messageOf(actuator).find("actuators[0].joint"), std::string::npos);
  actuator = onSlider(ActuatorType::Muscle), actuator.muscle.longest = 0.9;
  EXPECT_NE(messageOf(actuator).find("actuators[0].muscle.longest"), std::string::npos);
  actuator = onSlider(ActuatorType::Force), actuator.minForce = 2, actuator.maxForce = 1;
  EXPECT_NE(messageOf(actuator).find("actuators[0].maxForce"), std::string::npos);
}

}  // namespace
}  // namespace rubble
