// Prints the links and joints of SDFormat files as libsdformat reads them: see values.py.

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <limits>
#include <string>

#include <sdf/sdf.hh>

using Pose = ignition::math::Pose3d;

static const char *kind(sdf::JointType type) {
    switch (type) {
        case sdf::JointType::REVOLUTE: return "revolute";
        case sdf::JointType::CONTINUOUS: return "continuous";
        case sdf::JointType::PRISMATIC: return "prismatic";
        case sdf::JointType::FIXED: return "fixed";
        case sdf::JointType::BALL: return "ball";
        case sdf::JointType::UNIVERSAL: return "universal";
        case sdf::JointType::REVOLUTE2: return "revolute2";
        case sdf::JointType::SCREW: return "screw";
        default: return "other";
    }
}

// Prints the links and joints of a model at a pose in the world.
static void print(const sdf::Model &model, const std::string &prefix, bool is_static, const Pose &at) {
    is_static = is_static || model.Static();
    for (uint64_t k = 0; k < model.LinkCount(); k++) {
        const auto *link = model.LinkByIndex(k);
        std::cout << "link " << prefix << link->Name() << "\t" << (is_static ? "static" : "free");
        for (uint64_t c = 0; c < link->CollisionCount(); c++) {
            const auto *contact = link->CollisionByIndex(c)->Surface()->Contact();
            std::cout << "\t" << contact->CollideBitmask();
        }
        std::cout << "\n";
    }
    for (uint64_t k = 0; k < model.JointCount(); k++) {
        const auto *joint = model.JointByIndex(k);
        std::string parent, child;
        auto errors = joint->ResolveParentLink(parent);
        auto more = joint->ResolveChildLink(child);
        if (!errors.empty() || !more.empty()) {
            std::cout << "error\n";
        }
        std::cout << "joint " << prefix << joint->Name() << "\t" << kind(joint->Type()) << "\t"
                  << (parent == "world" ? "" : prefix) << parent << "\t" << (child == "world" ? "" : prefix) << child;
        if (const auto *axis = joint->Axis(0)) {
            std::cout << "\tlimits\t" << axis->Lower() << "\t" << axis->Upper();
        }
        Pose pose;
        if (!joint->SemanticPose().Resolve(pose, "__model__").empty()) {
            std::cout << "\nerror\n";
            continue;
        }
        pose = at * pose;
        std::cout << "\tpose\t" << pose.Pos().X() << "\t" << pose.Pos().Y() << "\t" << pose.Pos().Z() << "\t"
                  << pose.Rot().X() << "\t" << pose.Rot().Y() << "\t" << pose.Rot().Z() << "\t" << pose.Rot().W();
        for (int a = 0; a < 2; a++) {
            ignition::math::Vector3d xyz;
            const auto *axis = joint->Axis(a);
            if (axis && axis->ResolveXyz(xyz).empty()) {
                std::cout << "\taxis" << a << "\t" << xyz.X() << "\t" << xyz.Y() << "\t" << xyz.Z();
            }
        }
        std::cout << "\tthread\t" << joint->ThreadPitch() << "\n";
    }
    for (uint64_t k = 0; k < model.ModelCount(); k++) {
        const auto *inner = model.ModelByIndex(k);
        Pose pose;
        if (!inner->SemanticPose().Resolve(pose, "__model__").empty()) {
            std::cout << "error\n";
        }
        print(*inner, prefix + inner->Name() + "::", is_static, at * pose);
    }
}

int main(int count, char **files) {
    std::cout.precision(std::numeric_limits<double>::max_digits10);
    sdf::Console::Instance()->SetQuiet(true);
    const char *folders = std::getenv("MODELS");
    for (int k = 1; k < count; k++) {
        std::cout << "file " << files[k] << "\n";
        auto beside = std::filesystem::path(files[k]).parent_path().string();
        sdf::setFindCallback([&](const std::string &name) {
            auto at = name.find("://");
            auto bare = at == std::string::npos ? name : name.substr(at + 3);
            for (const auto &folder : {beside, std::string(folders ? folders : "")}) {
                auto path = folder + "/" + bare;
                if (std::filesystem::exists(path)) {
                    return path;
                }
            }
            return std::string();
        });
        sdf::Root root;
        auto errors = root.Load(files[k]);
        if (!errors.empty() || root.WorldCount() > 1) {
            std::cout << "error\n";
            continue;
        }
        if (root.Model()) {
            print(*root.Model(), "", false, root.Model()->RawPose());
        }
        for (uint64_t w = 0; w < root.WorldCount(); w++) {
            const auto *world = root.WorldByIndex(w);
            for (uint64_t m = 0; m < world->ModelCount(); m++) {
                const auto *model = world->ModelByIndex(m);
                Pose pose;
                if (!model->SemanticPose().Resolve(pose).empty()) {
                    std::cout << "error\n";
                }
                print(*model, model->Name() + "::", false, pose);
            }
        }
    }
}
