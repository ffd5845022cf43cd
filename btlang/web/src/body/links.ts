// The links of a body as shapes that move with its joints. The third axis points up, as on the map.
import { Box3, BoxGeometry, CylinderGeometry, Group, Mesh, SphereGeometry, Vector3, type BufferGeometry, type Material, type Object3D } from "three";
import { moving, type Joint, type Shape, type Urdf, type Vector } from "./urdf";

const ROUND = 24; // sides of a cylinder

export class Links {
  readonly group = new Group();
  /** Metres from the floor to its top, with all joints at zero. */
  readonly height: number;
  private movers: { joint: Joint; axis: Vector3; group: Group }[] = [];

  constructor(urdf: Urdf, material: Material) {
    const groups = new Map<string, Group>();
    for (const [link, shapes] of urdf.links) {
      const group = new Group();
      for (const shape of shapes) group.add(meshOf(shape, material));
      groups.set(link, group);
    }
    for (const joint of urdf.joints) {
      const frame = new Group().add(groups.get(joint.child)!);
      put(frame, joint.at, joint.turned);
      groups.get(joint.parent)!.add(frame);
    }
    this.group.add(groups.get(urdf.root)!);
    this.movers = moving(urdf).map((joint) => ({ joint, axis: new Vector3(...joint.axis).normalize(), group: groups.get(joint.child)! }));
    this.height = new Box3().setFromObject(this.group).max.z;
  }

  /** Radians and metres of the joints that move, in order; those that are missing at the end stay as they are. */
  pose(positions: number[]): void {
    for (const [index, position] of positions.slice(0, this.movers.length).entries()) {
      const { joint, axis, group } = this.movers[index]!;
      if (joint.kind === "turns") group.quaternion.setFromAxisAngle(axis, position);
      else group.position.copy(axis).multiplyScalar(position);
    }
  }
}

function meshOf({ kind, size, at, turned }: Shape, material: Material): Mesh {
  const mesh = new Mesh(geometryOf(kind, size), material);
  put(mesh, at, turned);
  return mesh;
}

function geometryOf(kind: Shape["kind"], [first = 0, second = 0, third = 0]: number[]): BufferGeometry {
  if (kind === "box") return new BoxGeometry(first, second, third);
  if (kind === "sphere") return new SphereGeometry(first, ROUND, ROUND / 2);
  return new CylinderGeometry(first, first, second, ROUND, 1, true).rotateX(Math.PI / 2); // which is upright along the second axis
}

function put(object: Object3D, at: Vector, turned: Vector): void {
  object.position.set(...at);
  object.rotation.set(...turned, "ZYX");
}
