// Jolt in the league, one thread: rings as static compounds of capsules, with the motion quality LinearCast.
//
// Usage: node in_jolt.mjs SCENES.json FOLDER

import { createRequire } from "node:module";
import initJolt from "jolt-physics";
import { capsule, scenes, steps, write } from "./league.mjs";

const { version } = createRequire(import.meta.url)("jolt-physics/package.json");
const Jolt = await initJolt();
const [FIXED, MOVING] = [0, 1];

const vec3 = (v) => new Jolt.Vec3(...v);
const quat = (q) => new Jolt.Quat(...q);

function physics() {
  const settings = new Jolt.JoltSettings();
  settings.mMaxWorkerThreads = 0;
  const objects = new Jolt.ObjectLayerPairFilterTable(2);
  objects.EnableCollision(FIXED, MOVING);
  objects.EnableCollision(MOVING, MOVING);
  const phases = new Jolt.BroadPhaseLayerInterfaceTable(2, 2);
  for (const layer of [FIXED, MOVING]) {
    phases.MapObjectToBroadPhaseLayer(layer, new Jolt.BroadPhaseLayer(layer));
  }
  settings.mObjectLayerPairFilter = objects;
  settings.mBroadPhaseLayerInterface = phases;
  settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(phases, 2, objects, 2);
  return new Jolt.JoltInterface(settings);
}

function made(shape) {
  if (shape.half) return new Jolt.BoxShape(vec3(shape.half), 0.01);
  const compound = new Jolt.StaticCompoundShapeSettings();
  const parts = shape.capsules.map((c) => capsule(c, [0, 1, 0]));
  if (parts.length === 1) return new Jolt.CapsuleShape(parts[0].half, parts[0].radius);
  for (const { middle, half, radius, turn } of parts) {
    compound.AddShapeShape(vec3(middle), quat(turn), new Jolt.CapsuleShape(half, radius), 0);
  }
  return compound.Create().Get();
}

function moving({ position, rotation, velocity, spin }, shape, form) {
  const place = new Jolt.RVec3(...position);
  const settings = new Jolt.BodyCreationSettings(form, place, quat(rotation), Jolt.EMotionType_Dynamic, MOVING);
  settings.mMotionQuality = Jolt.EMotionQuality_LinearCast;
  settings.mLinearDamping = 0;
  settings.mAngularDamping = 0;
  settings.mAllowSleeping = false;
  settings.mMaxAngularVelocity = 1000;
  settings.mLinearVelocity = vec3(velocity);
  settings.mAngularVelocity = vec3(spin);
  settings.mOverrideMassProperties = Jolt.EOverrideMassProperties_MassAndInertiaProvided;
  settings.mMassPropertiesOverride.mMass = shape.mass;
  settings.mMassPropertiesOverride.mInertia = Jolt.Mat44.prototype.sScaleVec3(vec3(shape.inertia));
  return settings;
}

function run(league, world, shapes) {
  const jolt = physics();
  const system = jolt.GetPhysicsSystem();
  const bodies = system.GetBodyInterface();
  system.SetGravity(vec3([0, world.gravity, 0]));
  const parameters = system.GetPhysicsSettings();
  if (world.restitution > 0) parameters.mMinVelocityForRestitution = 0;
  system.SetPhysicsSettings(parameters);
  const add = (settings) => {
    settings.mFriction = world.friction;
    settings.mRestitution = world.restitution;
    const body = bodies.CreateBody(settings);
    bodies.AddBody(body.GetID(), Jolt.EActivation_Activate);
    Jolt.destroy(settings);
    return body;
  };
  for (const { center, half } of world.walls) {
    const [place, turn] = [new Jolt.RVec3(...center), quat([0, 0, 0, 1])];
    const box = new Jolt.BoxShape(vec3(half));
    add(new Jolt.BodyCreationSettings(box, place, turn, Jolt.EMotionType_Static, FIXED));
  }
  const flying = world.bodies.map((b) => add(moving(b, league.shapes[b.shape], shapes[b.shape])));
  const numbers = (v) => [v.GetX(), v.GetY(), v.GetZ()];
  const state = () =>
    flying.map((body) => {
      // Each call gives the same object anew, so all is read at once.
      const place = numbers(body.GetPosition());
      const q = body.GetRotation();
      const turn = [q.GetX(), q.GetY(), q.GetZ(), q.GetW()];
      return [...place, ...turn, ...numbers(body.GetLinearVelocity()), ...numbers(body.GetAngularVelocity())];
    });
  const trajectory = steps(world, () => jolt.Step(world.dt, 1), state);
  Jolt.destroy(jolt);
  return trajectory;
}

const league = scenes();
const shapes = league.shapes.map(made);
shapes.forEach((shape) => shape.AddRef());
write("Jolt", version, "LinearCast", league.worlds.map((world) => run(league, world, shapes)));
