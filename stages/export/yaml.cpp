#include "stages/export/yaml.hpp"

#include "stages/error.hpp"
#include "stages/export/text.hpp"

namespace seampath::exporting {
namespace {

std::string path_word(Scanner& scan) {
    std::string word = scan.name();
    while (scan.accept('/')) {
        word += "/" + scan.name();
    }
    return word;
}

Yaml yaml_value(Scanner& scan) {
    Yaml result;
    if (scan.accept('{')) {
        do {
            const std::string name = scan.name();
            scan.expect(':');
            if (!result.members.emplace(name, yaml_value(scan)).second) {
                scan.fail("each field once before this place");
            }
        } while (scan.accept(','));
        scan.expect('}');
    } else if (scan.accept('[')) {
        if (!scan.accept(']')) {
            do {
                result.items.push_back(yaml_value(scan));
            } while (scan.accept(','));
            scan.expect(']');
        }
    } else if (scan.at_name()) {
        result.word = path_word(scan);
    } else {
        result.number = scan.decimal();
    }
    return result;
}

}  // namespace

const Yaml& Yaml::operator[](const std::string& name) const {
    const auto found = members.find(name);
    if (found == members.end()) {
        throw InternalError("export: ros: a field " + name + " was needed");
    }
    return found->second;
}

Yaml yaml_document(const TextFile& file) {
    Scanner scan(file, '#');
    Yaml root;
    while (!scan.done()) {
        const std::string name = scan.name();
        scan.expect(':');
        Yaml member;
        if (scan.accept('-')) {
            do {
                member.items.push_back(yaml_value(scan));
            } while (scan.accept('-'));
        } else {
            member = yaml_value(scan);
        }
        if (!root.members.emplace(name, member).second) {
            scan.fail("each field once before this place");
        }
    }
    return root;
}

}  // namespace seampath::exporting
