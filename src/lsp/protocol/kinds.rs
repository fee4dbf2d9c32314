//! Maps kinds of names, symbols, completion items and code actions to the protocol's kinds, which editors show as
//! icons.

use gen_lsp_types::{CodeActionKind, CompletionItemKind, DocumentHighlightKind, SymbolKind};

use crate::lsp::features::actions::ActionKind;
use crate::lsp::features::completion_items::CompletionKind;
use crate::lsp::features::structure::SymbolKind as PartKind;
use crate::syntax::occurrence::{NameKind, Role};

/// The symbol kind of a name.
pub(super) fn of_name(kind: NameKind) -> SymbolKind {
    match kind {
        NameKind::Entity => SymbolKind::Class,
        NameKind::Behavior => SymbolKind::Interface,
        NameKind::Argument => SymbolKind::TypeParameter,
        NameKind::World => SymbolKind::Module,
        NameKind::Space => SymbolKind::Namespace,
        NameKind::Group | NameKind::TileSet => SymbolKind::Enum,
        NameKind::Mode => SymbolKind::Method,
        NameKind::Constant | NameKind::Parameter => SymbolKind::Constant,
        NameKind::Variable | NameKind::Discrete | NameKind::Touched | NameKind::SignalNumber => SymbolKind::Variable,
        NameKind::Value | NameKind::Tag => SymbolKind::EnumMember,
        NameKind::Reference => SymbolKind::Field,
        NameKind::Button | NameKind::Axis | NameKind::Chance | NameKind::Signal => SymbolKind::Event,
        NameKind::Instance => SymbolKind::Object,
        NameKind::Condition | NameKind::Goal | NameKind::Never => SymbolKind::Boolean,
    }
}

/// The symbol kind of an entry of the outline.
pub(super) fn of_symbol(kind: PartKind) -> SymbolKind {
    match kind {
        PartKind::Name(kind) => of_name(kind),
        PartKind::File => SymbolKind::File,
        PartKind::Shape => SymbolKind::Object,
        PartKind::Edge => SymbolKind::Operator,
        PartKind::Spawn => SymbolKind::Constructor,
        PartKind::Tile => SymbolKind::EnumMember,
        PartKind::Player => SymbolKind::Key,
        PartKind::Limit => SymbolKind::Number,
        PartKind::Test => SymbolKind::Function,
    }
}

/// The kind of a completion item.
pub(super) fn of_completion(kind: CompletionKind) -> CompletionItemKind {
    match kind {
        CompletionKind::Mode => CompletionItemKind::Method,
        CompletionKind::Function => CompletionItemKind::Function,
        CompletionKind::Variable => CompletionItemKind::Field,
        CompletionKind::Instance => CompletionItemKind::Variable,
        CompletionKind::Entity => CompletionItemKind::Class,
        CompletionKind::Behavior => CompletionItemKind::Interface,
        CompletionKind::Space => CompletionItemKind::Module,
        CompletionKind::Property => CompletionItemKind::Property,
        CompletionKind::Group => CompletionItemKind::Enum,
        CompletionKind::Keyword => CompletionItemKind::Keyword,
        CompletionKind::Snippet => CompletionItemKind::Snippet,
        CompletionKind::File => CompletionItemKind::File,
        CompletionKind::Value => CompletionItemKind::EnumMember,
        CompletionKind::Constant => CompletionItemKind::Constant,
        CompletionKind::Input => CompletionItemKind::Event,
    }
}

/// The kind of a highlight: whether an occurrence reads or writes.
pub(super) fn of_highlight(role: Role) -> DocumentHighlightKind {
    match role {
        Role::Read => DocumentHighlightKind::Read,
        Role::Written | Role::Declared => DocumentHighlightKind::Write,
    }
}

/// The kind of a code action, by which editors filter them.
pub(super) fn of_action(kind: ActionKind) -> CodeActionKind {
    match kind {
        ActionKind::Fix | ActionKind::Suggestion => CodeActionKind::QuickFix,
        ActionKind::Extract => CodeActionKind::RefactorExtract,
        ActionKind::Inline => CodeActionKind::RefactorInline,
        ActionKind::Move => CodeActionKind::RefactorMove,
        ActionKind::Rewrite => CodeActionKind::RefactorRewrite,
        ActionKind::FixAll => CodeActionKind::SourceFixAll,
    }
}
