//! Shrinks a failing program by its text: removes lines and blocks, removes parts of lines, replaces expressions by
//! numbers, while it compiles and still fails.

/// The shortest text found for which `fails` holds.
pub fn shrunk(text: &str, fails: &mut dyn FnMut(&str) -> bool) -> String {
    let mut best = spread(text);
    if !fails(&best) {
        best = text.to_string();
    }
    for _ in 0..12 {
        let before = best.clone();
        drop_lines(&mut best, fails);
        replace_parts(&mut best, fails);
        if best == before {
            break;
        }
    }
    let tidy = unite(&best);
    if fails(&tidy) { tidy } else { best }
}

/// One statement on each line; not in maps, and not where a brace holds a domain.
fn spread(text: &str) -> String {
    let mut out = String::new();
    let mut in_map = false;
    for line in text.lines() {
        in_map ^= line.matches('"').count() % 2 == 1;
        if in_map || line.starts_with("discrete") {
            out.push_str(line);
        } else {
            out.push_str(&line.replace("; ", "\n").replace("{ ", "{\n").replace(" }", "\n}"));
        }
        out.push('\n');
    }
    out
}

/// Short blocks on one line again.
fn unite(text: &str) -> String {
    let lines: Vec<&str> = text.lines().filter(|l| !l.trim().is_empty()).collect();
    let mut out = String::new();
    let mut at = 0;
    while at < lines.len() {
        let line = lines[at];
        if line.ends_with('{') && lines.get(at + 1) == Some(&"}") {
            out.push_str(&format!("{line} }}\n"));
            at += 2;
        } else {
            out.push_str(&format!("{line}\n"));
            at += 1;
        }
    }
    out
}

/// The end of the block that a line opens, or the line itself.
fn block_end(lines: &[String], at: usize) -> usize {
    if lines[at].ends_with('"') && lines[at].matches('"').count() % 2 == 1 {
        return (at + 1..lines.len()).find(|i| lines[*i].trim() == "\"").unwrap_or(at);
    }
    if !lines[at].ends_with('{') {
        return at;
    }
    let mut depth = 0_i32;
    for (index, line) in lines.iter().enumerate().skip(at) {
        depth += i32::from(line.ends_with('{')) - i32::from(line.trim() == "}");
        if depth == 0 {
            return index;
        }
    }
    at
}

fn drop_lines(best: &mut String, fails: &mut dyn FnMut(&str) -> bool) {
    // Many lines at once first.
    let mut size = best.lines().count() / 4;
    while size > 3 {
        let mut at = 0;
        loop {
            let lines: Vec<&str> = best.lines().collect();
            if at >= lines.len() {
                break;
            }
            let rest: Vec<&str> =
                lines.iter().enumerate().filter(|(i, _)| !(at..at + size).contains(i)).map(|(_, l)| *l).collect();
            let text = rest.join("\n") + "\n";
            if fails(&text) {
                *best = text;
            } else {
                at += size;
            }
        }
        size /= 2;
    }
    let mut at = 0;
    loop {
        let lines: Vec<String> = best.lines().map(str::to_string).collect();
        if at >= lines.len() {
            break;
        }
        let end = block_end(&lines, at);
        let without = |gone: &dyn Fn(usize) -> bool| -> String {
            let kept = lines.iter().enumerate().filter(|(i, _)| !gone(*i)).map(|(_, l)| l.as_str());
            kept.collect::<Vec<_>>().join("\n") + "\n"
        };
        let all = without(&|i| (at..=end).contains(&i));
        let shell = without(&|i| i == at || i == end);
        if fails(&all) {
            *best = all;
        } else if end > at && fails(&shell) {
            *best = shell;
        } else {
            at += 1;
        }
    }
}

/// Removes or simplifies parts of lines, one after the other.
fn replace_parts(best: &mut String, fails: &mut dyn FnMut(&str) -> bool) {
    let mut at = 0;
    loop {
        let lines: Vec<String> = best.lines().map(str::to_string).collect();
        let Some(line) = lines.get(at) else { break };
        let mut is_better = false;
        for other in simpler(line) {
            let mut all = lines.clone();
            all[at].clone_from(&other);
            let text = all.join("\n") + "\n";
            if fails(&text) {
                *best = text;
                is_better = true;
                break;
            }
        }
        if !is_better {
            at += 1;
        }
    }
}

/// Simpler versions of a line, each of less weight, so that shrinking ends.
fn simpler(line: &str) -> Vec<String> {
    let mut out = Vec::new();
    let mut add = |from: usize, to: usize, with: &str| {
        if let (Some(head), Some(tail)) = (line.get(..from), line.get(to..)) {
            out.push(format!("{head}{with}{tail}"));
        }
    };
    // One operand of a word or an operator.
    for word in [" and ", " or ", " + ", " - ", " * ", " / "] {
        for (start, _) in line.match_indices(word) {
            let (from, to) = operand_ends(line, start, start + word.len());
            add(start, to, "");
            add(from, start + word.len(), "");
        }
    }
    // Brackets: only their content, only one argument, a number, nothing.
    let brackets = brackets(line);
    for &(name, open, close) in &brackets {
        let arguments = arguments(line, open, close);
        for &(from, to) in &arguments {
            add(name, close + 1, line[from..to].trim());
        }
        add(name, close + 1, "0");
        add(name, close + 1, "1");
        add(name, close + 1, "");
        for (index, &(from, to)) in arguments.iter().enumerate() {
            if index > 0 {
                add(arguments[index - 1].1, to, "");
            } else if let Some(next) = arguments.get(1) {
                add(from, next.0, "");
            }
            if line[from..to].trim().len() > 2 {
                add(from, to, "0");
                add(from, to, " 1");
                add(from, to, " 16");
            }
        }
    }
    // The right side of an update.
    for sign in [" := ", " = ", ": "] {
        if let Some(start) = line.find(sign) {
            let value = &line[start + sign.len()..];
            if value.len() > 2 && !value.starts_with("\"") {
                for with in ["0", "1", "16", "-60"] {
                    if with.len() < value.len() {
                        add(start + sign.len(), line.len(), with);
                    }
                }
            }
        }
    }
    for word in [
        "not ",
        "kinematic ",
        "initial ",
        ", keep velocity",
        ", bounce 1",
        ", bounce 0.6",
        ", bounce 0.3",
        ", carry",
        " from above",
        ", cloud",
        ", \"thin ice\"",
        "-",
    ] {
        for (start, _) in line.match_indices(word) {
            if word != "-" || line[start + 1..].starts_with(|c: char| c.is_alphanumeric() || c == '(') {
                add(start, start + word.len(), "");
            }
        }
    }
    if let Some(start) = line.find(" when ").filter(|_| !line.starts_with("when")) {
        add(start, line.len(), if line.ends_with('{') { " {" } else { "" });
    }
    let is_edge = line.starts_with("when") || line.starts_with("else");
    if let Some(start) = line.find(" -> ").filter(|_| is_edge) {
        add(start, line.len(), if line.ends_with('{') { " {" } else { "" });
    }
    if let Some(start) = line.find(" = ").filter(|_| line.starts_with("condition ")) {
        add(start + 3, line.len(), "true");
    }
    if line.starts_with("when ") {
        let to = line.find(" -> ").or_else(|| line.find(" {")).unwrap_or(line.len());
        if &line[5..to] != "true" {
            add(5, to, "true");
        }
    }
    // Numbers: round ones.
    let bytes = line.as_bytes();
    let mut start = 0;
    while start < bytes.len() {
        let is_number = bytes[start].is_ascii_digit()
            && (start == 0 || !(bytes[start - 1].is_ascii_alphanumeric() || matches!(bytes[start - 1], b'_' | b'.')));
        if !is_number {
            start += 1;
            continue;
        }
        let end =
            (start..bytes.len()).find(|i| !(bytes[*i].is_ascii_digit() || bytes[*i] == b'.')).unwrap_or(bytes.len());
        let number = &line[start..end];
        let cost = |n: &str| {
            (
                n.len(),
                n.parse::<f64>().map_or(9, |x| {
                    if x == 0.0 {
                        0
                    } else if x == 1.0 {
                        1
                    } else {
                        2
                    }
                }),
            )
        };
        for with in ["0", "1", "16", "60"] {
            if cost(with) < cost(number) {
                add(start, end, with);
            }
        }
        if number.contains('.') {
            let whole = number.split('.').next().unwrap_or("0");
            add(start, end, whole);
        }
        start = end;
    }
    out.retain(|other| other != line);
    out
}

/// From the start of the operand before an operator to the end of the one after it, at its level of brackets.
fn operand_ends(line: &str, left: usize, right: usize) -> (usize, usize) {
    let bytes = line.as_bytes();
    let mut depth = 0;
    let mut from = 0;
    for i in (0..left).rev() {
        match bytes[i] {
            b')' => depth += 1,
            b'(' if depth == 0 => {
                from = i + 1;
                break;
            }
            b'(' => depth -= 1,
            b',' if depth == 0 => {
                from = i + 1;
                break;
            }
            _ => {}
        }
        let rest = &line.get(i..left).unwrap_or("");
        if depth == 0
            && (rest.starts_with("= ")
                || rest.starts_with("when ")
                || rest.starts_with(": ")
                || rest.starts_with("> ")
                || rest.starts_with("< "))
        {
            from = i + rest.find(' ').map_or(0, |s| s + 1);
            break;
        }
    }
    let mut depth = 0;
    let mut to = line.len();
    for (i, byte) in bytes.iter().enumerate().skip(right) {
        match byte {
            b'(' => depth += 1,
            b')' if depth == 0 => {
                to = i;
                break;
            }
            b')' => depth -= 1,
            b',' if depth == 0 => {
                to = i;
                break;
            }
            _ => {}
        }
        let rest = line.get(i..).unwrap_or("");
        if depth == 0
            && [" -> ", " {", " and ", " or ", " < ", " > ", " <= ", " >= ", " == ", " != "]
                .iter()
                .any(|w| rest.starts_with(w))
        {
            to = i;
            break;
        }
    }
    (from, to)
}

/// Brackets with the word before them: the positions of the word and of both brackets.
fn brackets(line: &str) -> Vec<(usize, usize, usize)> {
    let bytes = line.as_bytes();
    let mut open = Vec::new();
    let mut out = Vec::new();
    for (i, c) in bytes.iter().enumerate() {
        match c {
            b'(' => open.push(i),
            b')' => {
                if let Some(start) = open.pop() {
                    let word = (0..start)
                        .rev()
                        .take_while(|j| bytes[*j].is_ascii_alphanumeric() || bytes[*j] == b'_')
                        .last()
                        .unwrap_or(start);
                    out.push((word, start, i));
                }
            }
            _ => {}
        }
    }
    // The outermost first.
    out.sort_by_key(|(_, open, close)| std::cmp::Reverse(close - open));
    out
}

fn arguments(line: &str, open: usize, close: usize) -> Vec<(usize, usize)> {
    let bytes = line.as_bytes();
    let mut depth = 0;
    let mut from = open + 1;
    let mut out = Vec::new();
    for (i, byte) in bytes.iter().enumerate().take(close).skip(open + 1) {
        match byte {
            b'(' => depth += 1,
            b')' => depth -= 1,
            b',' if depth == 0 => {
                out.push((from, i));
                from = i + 1;
            }
            _ => {}
        }
    }
    out.push((from, close));
    out
}
