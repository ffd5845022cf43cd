// What is around the body: the floor, the walls and boxes of the map, people and objects.
import { BoxGeometry, CapsuleGeometry, CylinderGeometry, Group, InstancedMesh, MeshLambertMaterial, Object3D, PlaneGeometry, Mesh, type BufferGeometry } from "three";
import type { Point, Robot, WorldMap } from "../fleet";
import { objectsOf, peopleOf } from "../watch/surroundings";

const FLOOR = 400; // metres
const WALL = { height: 0.9, thickness: 0.05 }; // metres: low, so that one sees over them
const BOX = 0.7; // metres
const PERSON = { height: 1.7, radius: 0.22 };
const OBJECT = 1; // metres
const MOST = 500; // people or objects that are drawn

type Place = [x: number, y: number, z: number, turned: number, length: number, width: number, height: number];

export class Room {
  readonly group = new Group();
  private floor = new MeshLambertMaterial();
  private wall = glassy();
  private box = glassy();
  private person = new MeshLambertMaterial();
  private object = glassy();
  private built = new Group();
  private people = many(new CapsuleGeometry(PERSON.radius, PERSON.height - 2 * PERSON.radius, 6, 16).rotateX(Math.PI / 2), this.person, MOST);
  private objects = many(new CylinderGeometry(1, 1, 1, 20).rotateX(Math.PI / 2), this.object, MOST);
  private map: WorldMap | null = null;

  constructor() {
    this.group.add(new Mesh(new PlaneGeometry(FLOOR, FLOOR), this.floor), this.built, this.people, this.objects);
  }

  /** Takes colours by their names in style/. */
  paint(colour: (name: string) => string): void {
    for (const [material, name] of [[this.floor, "quiet-ground"], [this.wall, "wall"], [this.box, "box"], [this.person, "person"], [this.object, "object"]] as const)
      material.color.setStyle(colour(name));
  }

  /** What is known by now. */
  show(robot: Robot): void {
    if (robot.map !== this.map) {
      this.map = robot.map;
      this.build();
    }
    fill(this.people, peopleOf(robot).map(({ x, y }) => [x, y, PERSON.height / 2, 0, 1, 1, 1]));
    fill(this.objects, objectsOf(robot).map(({ x, y, radius }) => [x, y, OBJECT / 2, 0, radius, radius, OBJECT]));
  }

  private build(): void {
    for (const each of [...this.built.children] as InstancedMesh[]) each.geometry.dispose(), each.dispose();
    this.built.clear();
    const walls = (this.map?.walls ?? []).flatMap((wall) => wall.slice(1).map((end, index) => along(wall[index]!, end)));
    const boxes = (this.map?.boxes ?? []).map(({ x, y, width, height }): Place => [x, y, BOX / 2, 0, width, height, BOX]);
    for (const [places, material] of [[walls, this.wall], [boxes, this.box]] as const) {
      const made = many(new BoxGeometry(1, 1, 1), material, Math.max(1, places.length));
      fill(made, places);
      this.built.add(made);
    }
  }
}

/** The robot is seen through it. */
function glassy(): MeshLambertMaterial {
  return new MeshLambertMaterial({ transparent: true, opacity: 0.5, depthWrite: false });
}

function along([x, y]: Point, [endX, endY]: Point): Place {
  const [across, up] = [endX - x, endY - y];
  return [x + across / 2, y + up / 2, WALL.height / 2, Math.atan2(up, across), Math.hypot(across, up) + WALL.thickness, WALL.thickness, WALL.height];
}

function many(geometry: BufferGeometry, material: MeshLambertMaterial, count: number): InstancedMesh {
  const mesh = new InstancedMesh(geometry, material, count);
  [mesh.count, mesh.frustumCulled] = [0, false];
  return mesh;
}

function fill(mesh: InstancedMesh, places: Place[]): void {
  const at = new Object3D();
  mesh.count = Math.min(places.length, mesh.instanceMatrix.count);
  for (const [index, [x, y, z, turned, length, width, height]] of places.slice(0, mesh.count).entries()) {
    at.position.set(x, y, z);
    at.rotation.z = turned;
    at.scale.set(length, width, height);
    at.updateMatrix();
    mesh.setMatrixAt(index, at.matrix);
  }
  mesh.instanceMatrix.needsUpdate = true;
}
