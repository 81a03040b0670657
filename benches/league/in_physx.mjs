// PhysX in the league: rings as bodies of many capsules, with CCD and with speculative CCD.
//
// Usage: node in_physx.mjs SCENES.json FOLDER

import { readFileSync } from "node:fs";
import initPhysX from "physx-js-webidl";
import { capsule, scenes, steps, write } from "./league.mjs";

// The package is for browsers alone and refuses Node.js by its version: it does not see it while it starts, and gets its
// wasm from here.
const wasmBinary = readFileSync("node_modules/physx-js-webidl/physx-js-webidl.wasm");
const node = process;
globalThis.window = globalThis;
delete globalThis.process;
const PhysX = await initPhysX({ wasmBinary });
globalThis.process = node;
const top = PhysX.PxTopLevelFunctions.prototype;
const foundation = top.CreateFoundation(PhysX.PHYSICS_VERSION, new PhysX.PxDefaultAllocator(), new PhysX.PxDefaultErrorCallback());
const scale = new PhysX.PxTolerancesScale();
const version = [24, 16, 8].map((bits) => (PhysX.PHYSICS_VERSION >> bits) & 255).join(".");
const physics = top.CreatePhysics(PhysX.PHYSICS_VERSION, foundation, scale);
const dispatcher = top.DefaultCpuDispatcherCreate(0);
const shapeFlags = new PhysX.PxShapeFlags(PhysX.PxShapeFlagEnum.eSIMULATION_SHAPE);
// Word 2 of the default filter shader's data: pairs with this flag get continuous collision detection.
const filter = new PhysX.PxFilterData(1, 0xffff, PhysX.PxPairFlagEnum.eDETECT_CCD_CONTACT, 0);

const vec3 = ([x, y, z]) => new PhysX.PxVec3(x, y, z);
const pose = (place, [x, y, z, w]) => new PhysX.PxTransform(vec3(place), new PhysX.PxQuat(x, y, z, w));

function geometries(shape) {
  if (shape.half) return [[new PhysX.PxBoxGeometry(...shape.half), pose([0, 0, 0], [0, 0, 0, 1])]];
  return shape.capsules.map((ends) => {
    const { middle, half, radius, turn } = capsule(ends, [1, 0, 0]);
    return [new PhysX.PxCapsuleGeometry(radius, half), pose(middle, turn)];
  });
}

function attach(actor, geometry, local, material) {
  const shape = physics.createShape(geometry, material, true, shapeFlags);
  shape.setLocalPose(local);
  shape.setSimulationFilterData(filter);
  actor.attachShape(shape);
  shape.release();
}

function run(league, world, parts, flag) {
  const settings = new PhysX.PxSceneDesc(scale);
  settings.gravity = vec3([0, world.gravity, 0]);
  settings.cpuDispatcher = dispatcher;
  settings.filterShader = top.DefaultFilterShader();
  settings.flags.raise(PhysX.PxSceneFlagEnum.eENABLE_CCD);
  if (world.restitution > 0) settings.bounceThresholdVelocity = 0.01;
  const scene = physics.createScene(settings);
  const material = physics.createMaterial(world.friction, world.friction, world.restitution);
  for (const { center, half } of world.walls) {
    const wall = physics.createRigidStatic(pose(center, [0, 0, 0, 1]));
    attach(wall, new PhysX.PxBoxGeometry(...half), pose([0, 0, 0], [0, 0, 0, 1]), material);
    scene.addActor(wall);
  }
  const bodies = world.bodies.map(({ shape, position, rotation, velocity, spin }) => {
    const body = physics.createRigidDynamic(pose(position, rotation));
    for (const [geometry, local] of parts[shape]) attach(body, geometry, local, material);
    body.setMass(league.shapes[shape].mass);
    body.setMassSpaceInertiaTensor(vec3(league.shapes[shape].inertia));
    body.setLinearDamping(0);
    body.setAngularDamping(0);
    body.setMaxAngularVelocity(1000);
    body.setSleepThreshold(0);
    if (world.restitution > 0) body.setMaxDepenetrationVelocity(0.01);
    body.setRigidBodyFlag(flag, true);
    body.setSolverIterationCounts(8, 2);
    body.setLinearVelocity(vec3(velocity));
    body.setAngularVelocity(vec3(spin));
    scene.addActor(body);
    return body;
  });
  const state = () =>
    bodies.map((body) => {
      const { p, q } = body.getGlobalPose();
      const numbers = [p.x, p.y, p.z, q.x, q.y, q.z, q.w];
      const v = body.getLinearVelocity();
      numbers.push(v.x, v.y, v.z);
      const w = body.getAngularVelocity();
      return [...numbers, w.x, w.y, w.z];
    });
  const step = () => {
    scene.simulate(world.dt);
    scene.fetchResults(true);
  };
  const trajectory = steps(world, step, state);
  scene.release();
  material.release();
  return trajectory;
}

const league = scenes();
const parts = league.shapes.map(geometries);
const settings = {
  CCD: PhysX.PxRigidBodyFlagEnum.eENABLE_CCD,
  "speculative CCD": PhysX.PxRigidBodyFlagEnum.eENABLE_SPECULATIVE_CCD,
};
for (const [setting, flag] of Object.entries(settings)) {
  write("PhysX", version, setting, league.worlds.map((world) => run(league, world, parts, flag)));
}
