// A robot with links in 3D, in its room, as its joints are now. Drawn only when something has changed.
import { DirectionalLight, HemisphereLight, Mesh, MeshLambertMaterial, PerspectiveCamera, RingGeometry, Scene, Spherical, Vector3, WebGLRenderer, type InstancedMesh } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { oncePerFrame } from "../dom";
import type { Robot } from "../fleet";
import { Links } from "./links";
import { Room } from "./room";
import { readUrdf } from "./urdf";

const NEAR = 0.05, FAR = 60; // metres
const EYE = { ahead: 2.9, left: 1.4, up: 1.8, looks: 0.95 }; // metres: where the camera is as seen from the robot, and the height that it looks at
const LEAST = 0.5, MOST = 15; // metres between the camera and the robot
const STEP = Math.PI / 24; // of a key
const CALM = 1000; // milliseconds between two postures for somebody who wants little motion
const PERIODS: [number, number] = [50, 250]; // milliseconds in which it moves to where it is said to be

/** Where the robot is, and its joints: what is between two of them is drawn, too. */
type Posture = number[];

/** `spot` is told where on the canvas the top of the body is, in pixels. */
export class BodyView {
  private renderer: WebGLRenderer;
  private scene = new Scene();
  private camera = new PerspectiveCamera(40, 1, NEAR, FAR);
  private controls: OrbitControls;
  private skin = new MeshLambertMaterial();
  private ring = new MeshLambertMaterial();
  private links: Links;
  private room = new Room();
  private shown: Posture = [];
  private from: Posture = [];
  private to: Posture = [];
  private came = 0;
  private seen: unknown[] = []; // that the picture depends on
  private period = PERIODS[0];
  private calm = matchMedia("(prefers-reduced-motion: reduce)");
  private timer = 0;
  private closed = false;
  private redraw = oncePerFrame(() => this.draw());
  private resized = new ResizeObserver(() => this.redraw());
  private paint = (): void => this.takeColours();
  private press = (event: KeyboardEvent): void => this.move(event);

  /** Throws an Error where the text is no URDF. */
  constructor(
    private canvas: HTMLCanvasElement,
    context: WebGL2RenderingContext,
    urdf: string,
    private spot: (x: number, y: number) => void,
  ) {
    this.links = new Links(readUrdf(urdf), this.skin);
    this.renderer = new WebGLRenderer({ canvas, context, antialias: true });
    this.camera.up.set(0, 0, 1);
    const sun = new DirectionalLight(0xffffff, 1.6);
    sun.position.set(3, 2, 6);
    const heading = new Mesh(new RingGeometry(0.34, 0.4, 40, 1, -Math.PI / 5, (2 * Math.PI) / 5), this.ring);
    heading.position.z = 0.01; // above the floor
    this.links.group.add(heading);
    this.scene.add(new HemisphereLight(0xffffff, 0x999999, 1.9), sun, this.room.group, this.links.group);
    this.controls = new OrbitControls(this.camera, canvas);
    Object.assign(this.controls, { minDistance: LEAST, maxDistance: MOST, maxPolarAngle: Math.PI / 2, enablePan: false });
    canvas.style.touchAction = "pan-y"; // a finger still scrolls the page
    this.controls.addEventListener("change", this.redraw);
    canvas.addEventListener("keydown", this.press);
    addEventListener("themechange", this.paint);
    this.resized.observe(canvas);
    this.takeColours();
  }

  /** Gives back all that the graphics card has of it. */
  close(): void {
    this.closed = true;
    clearTimeout(this.timer);
    this.resized.disconnect();
    removeEventListener("themechange", this.paint);
    this.canvas.removeEventListener("keydown", this.press);
    this.controls.dispose();
    this.scene.traverse((each) => (each as Mesh).geometry?.dispose());
    this.scene.traverse((each) => (each as InstancedMesh).isInstancedMesh && (each as InstancedMesh).dispose());
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  /** What is known of the robot by now. */
  show(robot: Robot): void {
    const seen = [robot.map, robot.things, robot.joints, robot.state, robot.speech];
    if (seen.every((each, index) => each === this.seen[index])) return;
    this.seen = seen;
    this.room.show(robot);
    const [x, y, heading] = robot.state?.pose ?? this.to.slice(0, 3);
    const known = this.to.slice(3);
    const to = [x ?? 0, y ?? 0, heading ?? 0, ...robot.joints.map((position, index) => position ?? known[index] ?? 0)];
    const before = this.to[2] ?? 0;
    to[2] = before + ((((to[2]! - before) % 360) + 540) % 360) - 180; // the short way round
    if (String(to) !== String(this.to)) this.go(to, robot);
    this.redraw();
  }

  private go(to: Posture, robot: Robot): void {
    const now = performance.now();
    if (this.calm.matches && now - this.came < CALM && this.shown.length) {
      this.timer ||= window.setTimeout(() => ((this.timer = 0), (this.seen = []), this.show(robot)), CALM);
      return;
    }
    const [least, most] = PERIODS;
    this.period = Math.min(Math.max(now - this.came, least), most);
    this.from = this.shown.length === to.length ? this.shown : to;
    [this.to, this.came] = [to, now];
    if (!this.shown.length) this.look(to);
  }

  /** The camera begins before the robot. */
  private look([x = 0, y = 0, heading = 0]: Posture): void {
    const [cos, sin] = [Math.cos((heading * Math.PI) / 180), Math.sin((heading * Math.PI) / 180)];
    this.controls.target.set(x, y, EYE.looks);
    this.camera.position.set(x + EYE.ahead * cos - EYE.left * sin, y + EYE.ahead * sin + EYE.left * cos, EYE.up);
  }

  private move(event: KeyboardEvent): void {
    const turns: Record<string, [number, number, number]> = {
      ArrowLeft: [-STEP, 0, 1], ArrowRight: [STEP, 0, 1], ArrowUp: [0, -STEP, 1], ArrowDown: [0, STEP, 1], "+": [0, 0, 0.9], "-": [0, 0, 1 / 0.9],
    };
    const turn = turns[event.key];
    if (!turn || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    const { x, y, z } = this.camera.position.clone().sub(this.controls.target);
    const around = new Spherical().setFromCartesianCoords(y, z, x); // whose second axis points up
    around.theta += turn[0];
    around.phi = Math.min(Math.max(around.phi + turn[1], 0.1), Math.PI / 2);
    around.radius = Math.min(Math.max(around.radius * turn[2], LEAST), MOST);
    const to = new Vector3().setFromSpherical(around);
    this.camera.position.set(to.z, to.x, to.y).add(this.controls.target);
    this.controls.update();
    this.redraw();
  }

  private takeColours(): void {
    const style = getComputedStyle(this.canvas);
    const colour = (name: string): string => style.getPropertyValue(`--${name}`).trim();
    this.room.paint(colour);
    this.skin.color.setStyle(colour("skin"));
    this.ring.color.setStyle(colour("running"));
    this.renderer.setClearColor(colour("surface"));
    this.redraw();
  }

  private draw(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (this.closed || !width || !height || !this.to.length) return;
    const now = performance.now();
    this.fit(width, height);
    const done = this.calm.matches ? 1 : Math.min(1, (now - this.came) / this.period);
    const [x = 0, y = 0] = this.shown.length ? this.shown : this.to;
    this.shown = this.to.map((each, index) => this.from[index]! + (each - this.from[index]!) * done);
    const moved = new Vector3(this.shown[0]! - x, this.shown[1]! - y, 0);
    this.camera.position.add(moved); // it goes along
    this.controls.target.add(moved);
    this.controls.update();
    this.place();
    this.renderer.render(this.scene, this.camera);
    if (done < 1) this.redraw();
  }

  private place(): void {
    const [x = 0, y = 0, heading = 0, ...joints] = this.shown;
    const { group } = this.links;
    group.position.set(x, y, 0);
    group.rotation.z = (heading * Math.PI) / 180;
    this.links.pose(joints);
    group.updateMatrixWorld();
    const top = new Vector3(x, y, this.links.height).project(this.camera);
    this.spot(((top.x + 1) / 2) * this.canvas.clientWidth, ((1 - top.y) / 2) * this.canvas.clientHeight);
  }

  private fit(width: number, height: number): void {
    const ratio = Math.min(devicePixelRatio || 1, 2);
    if (this.canvas.width === Math.floor(width * ratio) && this.canvas.height === Math.floor(height * ratio)) return;
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }
}
