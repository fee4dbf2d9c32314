//! Colours and line widths. The picture follows the reader's light or dark scheme; the most important elements have the
//! strongest colours: the path, then the goal, then solids.

/// The style sheet of the picture.
pub(super) const STYLE: &str = "\
text{font:12px system-ui,-apple-system,\"Segoe UI\",\"Helvetica Neue\",Arial,\"DejaVu Sans\",sans-serif;fill:#1f2328}
.paper{fill:#fff}.title{font-size:20px;font-weight:600}.quiet{fill:#59636e}.head{font-size:13px;font-weight:600}
.verdict{font-weight:600;text-anchor:middle;fill:#fff}.yes{fill:#1a7f37}.no{fill:#6e7781}
.air{fill:#f3f5f8}.frame{fill:none;stroke:#8c959f}.bounds{fill:none;stroke:#8c959f;stroke-dasharray:2 4}
.tile{shape-rendering:crispEdges}
.ground0{fill:#525c68}.ground1{fill:#7d6b5d}.ground2{fill:#5d7368}.ground3{fill:#716482}
.dim{fill:#b4bcc5}.cloud{fill:#525c68;fill-opacity:.28}.lip{fill:#525c68}.scenery{fill:#8c959f;fill-opacity:.28}
.wanted{fill:#2da44e;fill-opacity:.6}.feared{fill:#d1242f;fill-opacity:.7}
.accent0{fill:#8250df;fill-opacity:.45}.accent1{fill:#1b9aaa;fill-opacity:.45}.accent2{fill:#9a6700;fill-opacity:.45}
.accent3{fill:#c2559d;fill-opacity:.45}.accent4{fill:#7d8530;fill-opacity:.45}.accent5{fill:#3d7a8c;fill-opacity:.45}
.heat{fill:#0969da;shape-rendering:crispEdges}.tree{fill:none;stroke:#0a3069;stroke-opacity:.42;stroke-width:.7}.key{stroke-width:1.5;stroke-opacity:.8}
.layer{fill-opacity:.75;shape-rendering:crispEdges}.layer0{fill:#f6d55c}.layer1{fill:#f0a35e}.layer2{fill:#dd6e78}
.layer3{fill:#b4519d}.layer4{fill:#7a45b0}.layer5{fill:#3a3a9e}
.goal{fill:#2da44e;fill-opacity:.2}.rim{fill:none;stroke:#1a7f37;stroke-width:2;stroke-dasharray:7 4}
.link{fill:#8250df;fill-opacity:.14;stroke:#8250df;stroke-width:1.5;stroke-dasharray:3 2}
.thing{fill:#6639ba;fill-opacity:.2;stroke:#6639ba;stroke-width:1.5}.block{fill:#525c68;fill-opacity:.4;stroke:#414a55;stroke-width:1.5}
.asked{fill:#2da44e;fill-opacity:.25;stroke:#1a7f37;stroke-width:2}
.hero{fill:#bc4c00;fill-opacity:.2;stroke:#bc4c00;stroke-width:2}
.ghost{fill:none;stroke:#bc4c00;stroke-opacity:.6}
.sensor{fill:none;stroke-width:1.2;stroke-dasharray:3 2.5}
.ghostly{fill-opacity:.12;stroke-width:1.5;stroke-dasharray:5 2.5}
.trail{fill:none;stroke:#6639ba;stroke-opacity:.5;stroke-width:1.2;stroke-linejoin:round}
.mover{fill:none;stroke:#6639ba;stroke-opacity:.5}.gone{fill:none;stroke:#cf222e;stroke-width:2}
.casing,.route{fill:none;stroke-linejoin:round;stroke-linecap:round}
.casing{stroke:#fff;stroke-opacity:.85;stroke-width:6}.route{stroke:#e8590c;stroke-width:3}
.dot{fill:#fff;stroke:#bc4c00;stroke-width:1.3}.start{fill:#fff;stroke:#bc4c00;stroke-width:3}.end{fill:#bc4c00;stroke:#fff;stroke-width:2}
.door{fill:#bc4c00;stroke:#fff;stroke-width:1.5}.number{font-size:10px;font-weight:600;text-anchor:middle;fill:#fff}
.p2.hero{fill:#bf3989}.p2.hero,.p2.ghost,.p2.route,.p2.dot,.p2.start{stroke:#bf3989}.p2.end,.p2.door{fill:#bf3989}
.p3.hero{fill:#0b7285}.p3.hero,.p3.ghost,.p3.route,.p3.dot,.p3.start{stroke:#0b7285}.p3.end,.p3.door{fill:#0b7285}
.p4.hero{fill:#7d6608}.p4.hero,.p4.ghost,.p4.route,.p4.dot,.p4.start{stroke:#7d6608}.p4.end,.p4.door{fill:#7d6608}
.thing.sensor,.hero.sensor,.block.sensor,.asked.sensor{fill:none}
.reached{fill:#1a7f37;stroke:#fff;stroke-width:1.5}.broken{fill:#cf222e;stroke:#fff;stroke-width:1.5}
.sign{fill:none;stroke:#fff;stroke-width:2;stroke-linecap:round;stroke-linejoin:round}
.fold{fill:none;stroke:#59636e;stroke-width:2}.cut{font-size:11px;text-anchor:middle;fill:#59636e}
.name{font-size:11px;paint-order:stroke;stroke:#fff;stroke-opacity:.85;stroke-width:3px;stroke-linejoin:round}
.strong{font-weight:600;fill:#953800}.green{font-weight:600;fill:#116329}.violet{fill:#6639ba}.red{font-weight:600;fill:#a40e26}
@media(prefers-color-scheme:dark){text{fill:#e6edf3}.paper{fill:#0d1117}.quiet{fill:#9198a1}
.yes{fill:#238636}.verdict{fill:#fff}.air{fill:#131820}.frame,.bounds{stroke:#656c76}
.ground0{fill:#56606c}.ground1{fill:#77675a}.ground2{fill:#566f63}.ground3{fill:#6c5f80}
.layer4{fill:#8f5cc9}.layer5{fill:#5b5bd6}
.cloud{fill:#8b949e}.lip{fill:#9aa4b0}.heat{fill:#388bfd}.tree{stroke:#a5d6ff}
.rim{stroke:#3fb950}.link,.thing{fill:#ab7df8;stroke:#ab7df8}.block{fill:#7a8491;stroke:#9aa4b0}.asked{stroke:#3fb950}
.hero{fill:#f0883e;stroke:#f0883e}.ghost{stroke:#f0883e}.casing{stroke:#0d1117}.route{stroke:#ff8c38}
.dot{fill:#0d1117;stroke:#ffb77c}.start{fill:#0d1117;stroke:#ff8c38}.end{fill:#ff8c38;stroke:#0d1117}.door{stroke:#0d1117}
.name{stroke:#0d1117}.number{fill:#fff}.strong{fill:#ffb77c}.green{fill:#56d364}.violet{fill:#cfb3ff}.red{fill:#ff9492}
.dim{fill:#363d47}.trail,.mover{stroke:#ab7df8}.gone{stroke:#ff7b72}
.p2.hero{fill:#ff80c8}.p2.hero,.p2.ghost,.p2.route,.p2.dot,.p2.start{stroke:#ff80c8}.p2.end,.p2.door{fill:#d84a97}
.p3.hero{fill:#4ac9dd}.p3.hero,.p3.ghost,.p3.route,.p3.dot,.p3.start{stroke:#4ac9dd}.p3.end,.p3.door{fill:#0f7f92}
.p4.hero{fill:#d9b949}.p4.hero,.p4.ghost,.p4.route,.p4.dot,.p4.start{stroke:#d9b949}.p4.end,.p4.door{fill:#94790f}
.thing.sensor,.hero.sensor,.block.sensor,.asked.sensor{fill:none}
.reached,.broken{stroke:#0d1117}.reached{fill:#238636}.broken{fill:#da3633}.fold{stroke:#9198a1}.cut{fill:#9198a1}}";
