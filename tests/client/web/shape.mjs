// A TCP proxy as slow as a line: what comes from the server, of all connections together, leaves at so many
// bits a second; every byte takes half a round trip, and a new connection a whole one before.
import { connect, createServer } from 'node:net';

const PACKET_BYTES = 1448, HEAD_BYTES = 52, WAITS_MS = 200;

/** Acts that happen at their times, in the order in which they came. */
class Later {
	queue = [];
	last = 0;

	at(time, act) {
		this.last = Math.max(this.last, time);
		this.queue.push([this.last, act]);
		this.timer ??= setTimeout(() => this.run(), this.queue[0][0] - performance.now());
	}

	run() {
		while (this.queue.length && this.queue[0][0] <= performance.now() + 0.5)
			this.queue.shift()[1]();
		this.timer = this.queue.length
			? setTimeout(() => this.run(), this.queue[0][0] - performance.now()) : null;
	}
}

/** Listens on 127.0.0.1 before `port`, on any port or `own`; resolves to { port, close }. */
export function shape(port, bits_per_s, round_trip_ms, own = 0) {
	const sockets = new Set(), down = new Later();
	let free = 0;                            // when the line will have sent all that waits
	const server = createServer({ noDelay: true, allowHalfOpen: true }, (near) => {
		const far = connect({ port, host: '127.0.0.1', noDelay: true, allowHalfOpen: true });
		const end = () => [near, far].forEach((socket) => socket.destroy());
		for (const socket of [near, far]) {
			sockets.add(socket);
			socket.on('error', end).on('close', () => sockets.delete(socket));
		}
		const opened = performance.now() + round_trip_ms, up = new Later();
		const arrives = () => Math.max(opened, performance.now()) + round_trip_ms / 2;
		near.on('data', (bytes) => up.at(arrives(), () => far.write(bytes)));
		near.on('end', () => up.at(arrives(), () => far.end()));
		far.on('data', (bytes) => {
			for (let at = 0; at < bytes.length; at += PACKET_BYTES) {
				const packet = bytes.subarray(at, at + PACKET_BYTES);
				if (near.destroyed)
					break;
				free = Math.max(free, performance.now())
					+ (packet.length + HEAD_BYTES) * 8000 / bits_per_s;
				down.at(free + round_trip_ms / 2, () => near.write(packet));
			}
			// what waits for the line is bounded: then the server waits
			const over = free - performance.now() - WAITS_MS;
			if (over > 0) {
				far.pause();
				setTimeout(() => far.resume(), over);
			}
		});
		far.on('end', () => down.at(free + round_trip_ms / 2, () => near.end()));
	});
	return new Promise((done) => server.listen(own, '127.0.0.1', () => done({
		port: server.address().port,
		close() {
			server.close();
			sockets.forEach((socket) => socket.destroy());
		},
	})));
}
