/// Completion of command lines for shells, and the manual page, both from the program's own options.
#include <algorithm>
#include <cctype>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rubble/info.h>

#include "apps/cli/command.h"
#include "apps/cli/program.h"
#include "scenes/registry.h"

namespace rubble::cli {
namespace {

/// A subcommand with the words that lead to it.
struct Command {
  std::vector<std::string> words;
  const CLI::App* app;
};

void collect(const CLI::App& app, const std::vector<std::string>& words, std::vector<Command>& to) {
  to.push_back({words, &app});
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    std::vector<std::string> next = words;
    next.push_back(command->get_name());
    collect(*command, next, to);
  }
}
std::vector<Command> commandsOf(const CLI::App& app) {
  std::vector<Command> all;
  collect(app, {}, all);
  return all;
}

std::vector<std::string> flagsOf(const CLI::App& app) {
  std::vector<std::string> flags;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
    for (const std::string& name : option->get_snames()) flags.push_back("-" + name);
  }
  return flags;
}
std::vector<std::string> namesOf(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}
bool takesScene(const CLI::App& app) {
  return std::ranges::any_of(app.get_options(), [](const CLI::Option* option) {
    return option->get_positional() && option->get_name(true).rfind("scene", 0) == 0;
  });
}
std::string sceneNames() {
  std::vector<std::string> names;
  for (const scenes::Spec& spec : scenes::registry()) names.push_back(spec.name);
  return fmt::format("{}", fmt::join(names, " "));
}

/// The first line of a text, without marks that shells expand.
std::string plain(const std::string& text) {
  std::string out;
  for (const char c : text.substr(0, text.find('\n')))
    if (c != '\'' && c != '"' && c != '`' && c != '$' && c != '\\') out += c;
  return out;
}

std::string bash(const std::vector<Command>& all) {
  std::string cases;
  for (const Command& command : all) {
    std::vector<std::string> words = namesOf(*command.app), flags = flagsOf(*command.app);
    words.insert(words.end(), flags.begin(), flags.end());
    cases += fmt::format("    '{}') words='{}'{} ;;\n", fmt::join(command.words, " "), fmt::join(words, " "),
                         takesScene(*command.app) ? "\" $scenes\"" : "");
  }
  return fmt::format(
      "# bash completion of rubble: source <(rubble completion bash)\n"
      "_rubble() {{\n"
      "  local current=${{COMP_WORDS[COMP_CWORD]}} path='' words='' word\n"
      "  local scenes='{}'\n"
      "  for word in \"${{COMP_WORDS[@]:1:COMP_CWORD-1}}\"; do\n"
      "    case \" {} \" in *\" $path${{path:+/}}$word \"*) path=$path${{path:+/}}$word ;; esac\n"
      "  done\n"
      "  case \"${{path//\\// }}\" in\n{}  esac\n"
      "  COMPREPLY=($(compgen -W \"$words\" -- \"$current\") $(compgen -f -- \"$current\"))\n"
      "}}\n"
      "complete -o filenames -F _rubble rubble\n",
      sceneNames(),
      [&] {
        std::string paths;
        for (const Command& command : all)
          if (!command.words.empty()) paths += fmt::format("{} ", fmt::join(command.words, "/"));
        return paths;
      }(),
      cases);
}

std::string zsh(const std::vector<Command>& all) {
  return "#compdef rubble\n# zsh completion of rubble: source <(rubble completion zsh)\nautoload -U +X "
         "bashcompinit && bashcompinit\n" +
         bash(all);
}

std::string fish(const std::vector<Command>& all) {
  std::string out = "# fish completion of rubble: rubble completion fish | source\n";
  for (const Command& command : all) {
    std::string condition;
    for (const std::string& word : command.words) condition += "; and __fish_seen_subcommand_from " + word;
    condition = command.words.empty() ? "__fish_use_subcommand" : condition.substr(6);
    for (const CLI::App* sub : command.app->get_subcommands([](const CLI::App*) { return true; }))
      out += fmt::format("complete -c rubble -n '{}' -a {} -d '{}'\n", condition, sub->get_name(),
                         plain(sub->get_description()));
    for (const CLI::Option* option : command.app->get_options()) {
      std::string names;
      for (const std::string& name : option->get_snames()) names += " -s " + name;
      for (const std::string& name : option->get_lnames()) names += " -l " + name;
      if (!names.empty())
        out += fmt::format("complete -c rubble -n '{}'{} -d '{}'\n", condition, names,
                           plain(option->get_description()));
    }
    if (takesScene(*command.app))
      out += fmt::format("complete -c rubble -n '{}' -a '{}'\n", condition, sceneNames());
  }
  return out;
}

/// Text of a manual page: no line begins with a mark of troff.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') out += '\\';
    if (c == '-') out += '\\';
    if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n')) out += "\\&";
    out += c;
  }
  return out;
}

std::string manual(const CLI::App& app) {
  std::string out = fmt::format(
      ".TH RUBBLE 1 \"\" \"rubble {}\" \"User Commands\"\n.SH NAME\nrubble \\- {}\n", buildInfo().version,
      roff("rigid-body physics by augmented vertex block descent"));
  out += ".SH SYNOPSIS\n.B rubble\n.I COMMAND\n[OPTIONS]\n.SH DESCRIPTION\n" + roff(app.get_description()) +
         "\n";
  out += ".SH COMMANDS\n";
  for (const Command& command : commandsOf(app)) {
    if (command.words.empty()) continue;
    out += fmt::format(".SS rubble {}\n{}\n", fmt::join(command.words, " "),
                       roff(command.app->get_description()));
    for (const CLI::Option* option : command.app->get_options()) {
      const bool flag = option->get_items_expected_max() == 0;
      out += fmt::format(
          ".TP\n.B {}{}\n{}\n", roff(option->get_name(option->get_positional(), !option->get_positional())),
          flag ? "" : " \\fI" + roff(option->get_type_name()) + "\\fP", roff(option->get_description()));
    }
  }
  return out + ".SH EXIT STATUS\n0: the verdict holds. 1: it does not. 2: bad input or usage.\n";
}

}  // namespace

void addCompletion(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand("completion", "Print completion of command lines for a shell");
  auto shell = std::make_shared<std::string>();
  command->add_option("shell", *shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  command->callback([&app, shell, &status] {
    const std::vector<Command> all = commandsOf(app);
    fmt::print("{}", *shell == "bash" ? bash(all) : *shell == "zsh" ? zsh(all) : fish(all));
    status = kHolds;
  });
  CLI::App* man = app.add_subcommand("man", "Print the manual page: rubble man | man -l -");
  man->callback([&app, &status] {
    fmt::print("{}", manual(app));
    status = kHolds;
  });
}

}  // namespace rubble::cli
