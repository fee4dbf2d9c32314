//! The language service without a connection, as the editor of the playground uses it: offsets count UTF-16 code units.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use hypedc::lsp::service::{Answer, Edit, Finding, Request, Service};

use super::client::Memory;

const PATH: &str = "a.hyped";

fn service(files: &[(&str, &str)]) -> Service {
    let files: BTreeMap<PathBuf, String> =
        files.iter().map(|(path, text)| (PathBuf::from(path), (*text).to_string())).collect();
    Service::new(Arc::new(Memory(files)))
}

fn findings(answer: Answer) -> Vec<Finding> {
    let Answer::Findings { findings } = answer else { panic!("{answer:?}") };
    findings
}

fn document(service: &mut Service, text: &str) -> Vec<Finding> {
    findings(service.answer(Request::Document { path: PATH.into(), text: text.into() }))
}

/// The offset of a text in another one.
fn units(text: &str, of: &str) -> usize {
    text[..text.find(of).unwrap()].encode_utf16().count()
}

/// The part of a text between two offsets.
fn part(text: &str, from: usize, to: usize) -> String {
    String::from_utf16(&text.encode_utf16().collect::<Vec<_>>()[from..to]).unwrap()
}

fn edited(text: &str, edits: &[Edit]) -> String {
    edits.iter().rev().fold(text.to_string(), |text, edit| {
        let end = text.encode_utf16().count();
        part(&text, 0, edit.from) + &edit.text + &part(&text, edit.to, end)
    })
}

#[test]
fn findings_and_their_repairs_are_at_their_offsets() {
    let mut service = service(&[]);
    let text = "// \u{1f40a} é\nentity A {\n    mode up { when y > 3 -> dwn }\n    mode down { y' = -1 }\n}\n";
    let found = document(&mut service, text);
    let [finding] = found.as_slice() else { panic!("{found:?}") };
    assert_eq!((finding.severity.as_str(), finding.path.as_str()), ("error", PATH));
    assert_eq!(part(text, finding.from, finding.to), "dwn");
    let fix = finding.fix.as_ref().unwrap();
    let mended = edited(text, &fix.edits);
    assert_eq!(mended, text.replace("dwn", "down"));
    assert_eq!(document(&mut service, &mended), []);
}

#[test]
fn what_an_import_has_is_told_with_its_path() {
    let mut service = service(&[("parts/slime.hyped", "entity Slime { x' = sped }\n")]);
    let found = document(&mut service, "import \"parts/slime.hyped\"\n");
    assert_eq!(found.iter().map(|f| f.path.as_str()).collect::<Vec<_>>(), ["parts/slime.hyped"]);
    // The text of an editor takes the place of the file.
    let mend = Request::Document { path: "parts/slime.hyped".into(), text: "entity Slime { x' = 3 }\n".into() };
    assert_eq!(findings(service.answer(mend)), []);
    let path = PATH.to_string();
    assert_eq!(findings(service.answer(Request::Analyze { path })), []);
}

#[test]
fn the_analysis_of_values_adds_its_findings_and_ranges() {
    let text = include_str!("slime.hyped");
    let mut service = service(&[]);
    let before = document(&mut service, text);
    let after = findings(service.answer(Request::Analyze { path: PATH.into() }));
    let added: Vec<&Finding> = after.iter().filter(|found| !before.contains(found)).collect();
    assert!(!added.is_empty() && after.len() == before.len() + added.len(), "{after:?}");
    assert!(added.iter().all(|found| found.severity == "warning" && found.from < found.to), "{added:?}");
}

#[test]
fn words_are_completed_explained_and_found() {
    let text = "entity Ä {\n    param speed = 3\n    x' = sp\n}\n";
    let mut service = service(&[]);
    document(&mut service, text);
    let at = units(text, "sp\n") + 2;
    let Answer::Completion { from, to, items, .. } = service.answer(Request::Completion { path: PATH.into(), at })
    else {
        panic!()
    };
    assert_eq!(part(text, from, to), "sp");
    assert!(items.iter().any(|item| item.label == "speed" && item.kind == "constant"), "{items:?}");
    let at = units(text, "speed");
    let Answer::Hover { from, to, markdown } = service.answer(Request::Hover { path: PATH.into(), at }) else {
        panic!()
    };
    assert_eq!(part(text, from, to), "speed");
    assert!(markdown.contains("param speed = 3"), "{markdown}");
    let text = text.replace("sp\n", "speed\n");
    document(&mut service, &text);
    let at = units(&text, "= speed") + 3;
    let Answer::Definition { path, from, to } = service.answer(Request::Definition { path: PATH.into(), at }) else {
        panic!()
    };
    assert_eq!((path.as_str(), from, to), (PATH, units(&text, "speed"), units(&text, "speed") + 5));
    let Answer::Symbols { symbols } = service.answer(Request::Symbols { path: PATH.into() }) else { panic!() };
    assert_eq!((symbols[0].name.as_str(), symbols[0].name_from, symbols[0].name_to), ("Ä", 7, 8));
    let call = text.replace("speed\n", "min(1, \n");
    document(&mut service, &call);
    let at = units(&call, "min(1, ") + 7;
    let Answer::Signatures { signatures, argument, .. } = service.answer(Request::Signature { path: PATH.into(), at })
    else {
        panic!()
    };
    assert_eq!((signatures[0].name.as_str(), argument), ("min", 1));
}

#[test]
fn tokens_are_in_order_and_name_what_they_are() {
    let text = include_str!("slime.hyped");
    let mut service = service(&[]);
    document(&mut service, text);
    let Answer::Tokens { kinds, tokens } = service.answer(Request::Tokens { path: PATH.into() }) else { panic!() };
    assert!(tokens.len() > 20 && tokens.windows(2).all(|two| two[0][1] <= two[1][0]), "{tokens:?}");
    let keyword = kinds.iter().position(|kind| kind == "keyword").unwrap();
    let words: Vec<String> =
        tokens.iter().filter(|token| token[2] == keyword).map(|token| part(text, token[0], token[1])).collect();
    assert!(words.contains(&"entity".to_string()), "{words:?}");
}

#[test]
fn formatting_gives_the_canonical_layout() {
    let mut service = service(&[]);
    let text = "// é\u{1f40a}\nentity   A {\nx' =  3\n\n\n\n}\n";
    document(&mut service, text);
    let Answer::Edits { edits } = service.answer(Request::Format { path: PATH.into() }) else { panic!() };
    assert_eq!(edited(text, &edits), "// é\u{1f40a}\nentity A {\n    x' = 3\n}\n");
    document(&mut service, "entity {");
    assert_eq!(service.answer(Request::Format { path: PATH.into() }), Answer::Nothing);
}

#[test]
fn any_position_of_any_part_of_a_text_is_answered() {
    let text = include_str!("slime.hyped");
    let mut service = service(&[]);
    let path = || PATH.to_string();
    assert_eq!(service.answer(Request::Hover { path: path(), at: 0 }), Answer::Nothing, "it is not open");
    let mut answered = 0;
    for end in (0..text.len()).step_by(17).filter(|end| text.is_char_boundary(*end)) {
        document(&mut service, &text[..end]);
        for at in [0, end / 2, end, end + 9, usize::MAX] {
            for request in [
                Request::Hover { path: path(), at },
                Request::Completion { path: path(), at },
                Request::Signature { path: path(), at },
                Request::Definition { path: path(), at },
            ] {
                answered += usize::from(service.answer(request) != Answer::Nothing);
            }
        }
        service.answer(Request::Tokens { path: path() });
        service.answer(Request::Symbols { path: path() });
        service.answer(Request::Analyze { path: path() });
    }
    assert!(answered > 50, "{answered}");
}
