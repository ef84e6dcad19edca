// The viewer's camera, in metres from the scene's origin, Z up. It orbits about a target, walks on
// the ground, or flies. Mouse, touch and keyboard do the same three things: turn, move, come nearer.

const FOV_Y_DEG = 45, PITCH_MAX = 1.55, TURN = 0.005, KEY_TURN = 1.2;
const FLAT = -0.33, STEEP = -0.8;        // pitch of the flattest first view, and of the steepest
const CLOSE = 0.9;                       // a first view is so much nearer than where all corners are seen
const HAZE_M = 20000;                    // as view_select.h has it
const EYE_M = 1.7;                       // above the ground, of who walks
const CLICK_PX = 6, CLICK_MS = 600;      // a pointer that moves more, or is held longer, drags
const keys = { a: [-1, 0, 0], d: [1, 0, 0], w: [0, 1, 0], s: [0, -1, 0], q: [0, 0, -1], e: [0, 0, 1] };
const turns = { arrowleft: [1, 0], arrowright: [-1, 0], arrowup: [0, 1], arrowdown: [0, -1] };
const zooms = { '+': 1, '=': 1, '-': -1 };
export const cameraKeys = new Set([...Object.keys(keys), ...Object.keys(turns), ...Object.keys(zooms)]);

/** Keys with a modifier are the browser's. */
export const withModifier = (event) => event.ctrlKey || event.metaKey || event.altKey;

const sum = (list) => list.reduce((a, b) => a.map((v, i) => v + b[i]));

export class Camera {
	constructor() {
		this.mode = 'orbit';
		this.target = [0, 0, 0];
		this.distance = 50;
		this.yaw = Math.PI / 2;         // counter-clockwise from +X
		this.pitch = -0.35;
		this.near = 0.1;
		this.far = 1e5;
		this.held = new Set();
	}

	forward() {
		const flat = Math.cos(this.pitch);
		return [flat * Math.cos(this.yaw), flat * Math.sin(this.yaw), Math.sin(this.pitch)];
	}

	view() {
		const f = this.forward();
		const eye = this.target.map((v, i) => v - f[i] * this.distance);
		return { eye, target: [...this.target], up: [0, 0, 1], fov_y_deg: FOV_Y_DEG };
	}

	/** Clockwise from north (+Y). */
	heading() {
		return Math.PI / 2 - this.yaw;
	}

	/** Height of what is seen at the target's distance. */
	metresAcross() {
		return 2 * this.distance * Math.tan(FOV_Y_DEG * Math.PI / 360);
	}

	/** From how near on, and how far a scene is drawn. */
	reach({ low, high }, near) {
		[this.near, this.far] = [near, Math.hypot(...high.map((v, i) => v - low[i])) * 20 + 1e4];
	}

	/** Looks at a box from the south and from above. `aspect`: the picture's width over its height; below 1 the camera
	 * looks more from above, since a box would fill little of the height. `whole`: all corners are seen. Else, where
	 * the width needs a larger distance than the height, the distance is the geometric mean of the two. */
	frame({ low, high }, aspect, whole = false) {
		const half = high.map((v, i) => (v - low[i]) / 2);
		[this.yaw, this.pitch] = [Math.PI / 2, Math.max(FLAT / Math.min(aspect, 1), STEEP)];
		const [, ahead, down] = this.forward(), tan = Math.tan(FOV_Y_DEG * Math.PI / 360);
		const corners = [-1, 1].flatMap((south) => [-1, 1].map((top) => [south * half[1], top * half[2]]));
		const fits = (across) => Math.max(...corners.map((corner) => across(corner) / tan
			- (corner[0] * ahead + corner[1] * down)), this.near * 10);
		const wide = fits(() => half[0] / aspect), tall = fits(([y, z]) => Math.abs(z * ahead - y * down));
		this.target = low.map((v, i) => (v + high[i]) / 2);
		this.distance = whole ? Math.max(tall, wide) : CLOSE * Math.min(tall, Math.sqrt(tall * wide));
	}

	/** Takes the view from one scene (openapi.yaml's Scene) to another, if both lie at the same place: their bounds are
	 * much the same, or, by a common CRS, the other has what is looked at. False: nothing changes. */
	transfer(from, to, moves = true) {
		const way = [0, 1, 2].map((i) => (from.origin?.at[i] ?? 0) - (to.origin?.at[i] ?? 0));
		const target = sum([this.target, way]), [a, b] = [from.bounds, to.bounds];
		const size = ({ low, high }, i) => high[i] - low[i];
		const common = (i) => Math.min(a.high[i] + way[i], b.high[i]) - Math.max(a.low[i] + way[i], b.low[i]);
		const isSame = [0, 1].every((i) => common(i) >= Math.max(size(a, i), size(b, i)) / 2);
		const isWithin = to.origin && [0, 1].every((i) => target[i] >= b.low[i] && target[i] <= b.high[i])
			&& this.distance < 4 * Math.hypot(size(b, 0), size(b, 1));
		if (from.origin?.crs !== to.origin?.crs || !(isSame || isWithin))
			return false;
		this.target = moves ? target : this.target;
		return true;
	}

	/** Metres of haze as EcoLayer has them: the usual, unless more than a fifth of what is looked at is haze. */
	haze() {
		return 4 * this.distance > HAZE_M ? 4 * this.distance : 0;
	}

	look(eye, target) {
		const d = target.map((v, i) => v - eye[i]), length = Math.hypot(...d);
		if (!(length > 0))
			return;
		[this.target, this.distance] = [[...target], length];
		this.yaw = Math.atan2(d[1], d[0]);
		this.pitch = Math.max(-PITCH_MAX, Math.min(PITCH_MAX, Math.asin(d[2] / length)));
	}

	/** Looks at a target of that size (0: of none), from where the eye is now or nearer. */
	approach(target, size) {
		const { eye } = this.view();
		this.look(eye, target);
		if (size)
			this.distance = Math.min(this.distance, Math.max(size * 1.5, this.near * 10));
	}

	/** Stands on the ground of that height; whether that moves the eye. */
	stand(height) {
		const rise = height + EYE_M - this.view().eye[2];
		this.target[2] += rise;
		return Math.abs(rise) > 0.01;
	}

	/** The same for an eye that is below it. */
	lift(height) {
		return this.view().eye[2] < height + EYE_M && this.stand(height);
	}

	/** From now on it orbits, walks or flies. A walk begins with a look ahead, and not far. */
	setMode(mode) {
		if (mode === 'walk' && this.mode !== 'walk') {
			const { eye } = this.view();
			this.pitch = 0;
			this.distance = Math.min(this.distance, 20);
			this.target = this.forward().map((v, i) => eye[i] + v * this.distance);
		}
		this.mode = mode;
	}

	/** View and projection, column by column. */
	matrix(aspect) {
		const { eye } = this.view(), f = this.forward(), { near, far } = this;
		const y = 1 / Math.tan(FOV_Y_DEG * Math.PI / 360), x = y / aspect;
		const right = [Math.sin(this.yaw), -Math.cos(this.yaw), 0];
		const up = [right[1] * f[2], -right[0] * f[2], right[0] * f[1] - right[1] * f[0]];
		const a = (far + near) / (far - near), b = -2 * far * near / (far - near);
		const rows = [right.map((v) => v * x), up.map((v) => v * y), f.map((v) => v * a), f];
		const at = rows.map((r) => -(r[0] * eye[0] + r[1] * eye[1] + r[2] * eye[2]));
		at[2] += b;
		return [0, 1, 2].flatMap((column) => rows.map((r) => r[column])).concat(at);
	}

	// ---- Moving ----

	/** Turns about the target, or, walking and flying, about the eye. */
	turn(yaw, pitch) {
		const { eye } = this.view();
		this.yaw += yaw;
		this.pitch = Math.max(-PITCH_MAX, Math.min(PITCH_MAX, this.pitch + pitch));
		if (this.mode !== 'orbit')
			this.target = this.forward().map((v, i) => eye[i] + v * this.distance);
	}

	/** To the right, forward and up. A flight goes where the camera looks, all others stay level. */
	move(right, ahead, up) {
		const level = [Math.cos(this.yaw), Math.sin(this.yaw), 0];
		const way = this.mode === 'fly' ? this.forward() : level;
		const aside = [level[1] * right, -level[0] * right, up];
		this.target = sum([this.target, aside, way.map((v) => v * ahead)]);
	}

	zoom(steps) {
		const factor = 0.85 ** steps;
		if (this.mode === 'orbit')
			this.distance = Math.max(this.distance * factor, this.near * 4);
		else
			this.move(0, this.distance * (1 - factor), 0);
	}

	moving() {
		return this.held.size > 0;
	}

	/** Moves by held keys for the time that has passed; whether they do anything. */
	step(now) {
		const s = Math.min((now - (this.last ?? now)) / 1000, 0.1);
		const speed = this.mode === 'walk' ? 3 : Math.max(this.distance * 0.6, 2);
		this.last = now;
		for (const key of this.held) {
			if (keys[key])
				this.move(...keys[key].map((v) => v * speed * s));
			else if (turns[key])
				this.turn(turns[key][0] * KEY_TURN * s, turns[key][1] * KEY_TURN * s);
			else
				this.zoom(zooms[key] * s * 5);
		}
		return this.held.size > 0;
	}

	/** Takes mouse, touch and keyboard; `moved` is called at each change, `clicked` with where it was: x
	 * and y in [0, 1], from the top left. */
	listen(element, moved, clicked) {
		const fingers = new Map();
		let press = null;
		const drag = (dx, dy, moves) => {
			if (moves) {
				const metres = this.metresAcross() / element.clientHeight;
				this.move(-dx * metres, dy * metres, 0);
			} else {
				// what is dragged follows the pointer
				const way = this.mode === 'orbit' ? -TURN : TURN;
				this.turn(dx * way, dy * way);
			}
			moved();
		};
		const apart = () => {
			const [a, b] = [...fingers.values()];
			return Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
		};
		element.addEventListener('pointerdown', (event) => {
			element.setPointerCapture(event.pointerId);
			fingers.set(event.pointerId, event);
			press = fingers.size === 1 && event.button === 0 ? event : null;
		});
		element.addEventListener('pointermove', (event) => {
			const before = fingers.get(event.pointerId);
			if (!before)
				return;
			if (press && Math.hypot(event.clientX - press.clientX, event.clientY - press.clientY)
					> CLICK_PX)
				press = null;
			const distance = fingers.size === 2 ? apart() : 0, share = 1 / fingers.size;
			fingers.set(event.pointerId, event);
			if (distance)
				this.zoom(Math.log(apart() / distance) * 6);
			const dx = event.clientX - before.clientX, dy = event.clientY - before.clientY;
			const moves = fingers.size > 1 || event.buttons & 6 || event.shiftKey;
			drag(dx * share, dy * share, moves);
		});
		element.addEventListener('pointerup', (event) => {
			const box = element.getBoundingClientRect();
			if (press && event.timeStamp - press.timeStamp < CLICK_MS)
				clicked([(event.clientX - box.x) / box.width,
					(event.clientY - box.y) / box.height]);
			press = null;
		});
		for (const name of ['pointerup', 'pointercancel'])
			element.addEventListener(name, (event) => fingers.delete(event.pointerId));
		element.addEventListener('contextmenu', (event) => event.preventDefault());
		element.addEventListener('wheel', (event) => {
			event.preventDefault();
			this.zoom(-event.deltaY / (event.deltaMode ? 3 : 100));
			moved();
		}, { passive: false });
		addEventListener('keydown', (event) => {
			const key = event.key.toLowerCase();
			const typing = event.target.matches('select, input');
			if (withModifier(event) || typing || !cameraKeys.has(key))
				return;
			event.preventDefault();
			this.held.add(key);
			moved();
		});
		addEventListener('keyup', (event) => this.held.delete(event.key.toLowerCase()));
		addEventListener('blur', () => this.held.clear());
	}
}
