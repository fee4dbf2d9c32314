// Times steps: natively and as WebAssembly, alternately; medians. node measure.mjs MODULE… (HYPEDC_NATIVE names the native
// engine.) Prints ns per step, and the medians of the ratios.
import { NativeEngine, WebEngine } from "./engines.mjs";
import { games, repository } from "./games.mjs";

const modules = process.argv.slice(2);
if (modules.length === 0) modules.push(`${repository}/bindings/web/dist/hypedc.wasm`);
const [rounds, steps] = [Number(process.env.ROUNDS ?? 21), Number(process.env.STEPS ?? 20_000)];
const native = new NativeEngine(process.env.HYPEDC_NATIVE ?? `${repository}/target/release/native`);
const median = (all) => all.sort((a, b) => a - b)[all.length >> 1];

for (const name of ["smb/smb, mario-1-1.txt", "paper/test1"]) {
  const { project } = games().find((game) => game.name === name);
  const webs = modules.map((path) => new WebEngine(path));
  const files = { ask: "files", ...project };
  for (const web of webs) web.ask(files);
  await native.ask(files);
  // Without steps: what compiling takes, which the time of a request includes.
  const play = (count) => ({ ask: "random_steps", seed: 1, steps: count });
  const timed = (web, request) => {
    const before = performance.now();
    web.ask(request);
    return (performance.now() - before) * 1e6;
  };
  const times = modules.map(() => []);
  const natives = [];
  for (let round = 0; round < rounds; round += 1) {
    await native.ask(play(0));
    const base = native.seconds;
    await native.ask(play(steps));
    natives.push(((native.seconds - base) * 1e9) / steps);
    webs.forEach((web, at) => {
      const empty = timed(web, play(0));
      times[at].push((timed(web, play(steps)) - empty) / steps);
    });
  }
  modules.forEach((path, at) => {
    const ratio = median(times[at].map((time, round) => time / natives[round]));
    const [web, own] = [median([...times[at]]), median([...natives])];
    console.log(`${name}: ${path}: native ${own.toFixed(0)} ns, WebAssembly ${web.toFixed(0)} ns, ratio ${ratio.toFixed(2)}`);
  });
}
native.end();
