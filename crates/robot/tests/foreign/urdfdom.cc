// Prints the joints of URDF files as urdfdom reads them: see values.py.

#include <cstdio>
#include <fstream>
#include <iostream>
#include <limits>
#include <sstream>

#include <urdf_parser/urdf_parser.h>

static const char *const KINDS[] = {"unknown", "revolute", "continuous", "prismatic", "floating", "planar", "fixed"};

int main(int count, char **files) {
    std::cout.precision(std::numeric_limits<double>::max_digits10);
    for (int k = 1; k < count; k++) {
        std::cout << "file " << files[k] << "\n";
        std::ifstream in(files[k]);
        std::stringstream text;
        text << in.rdbuf();
        auto model = urdf::parseURDF(text.str());
        if (!model) {
            std::cout << "error\n";
            continue;
        }
        for (const auto &[name, joint] : model->joints_) {
            std::cout << "joint " << name << "\t" << KINDS[joint->type] << "\t" << joint->parent_link_name << "\t"
                      << joint->child_link_name;
            if (joint->limits) {
                std::cout << "\tlimits\t" << joint->limits->lower << "\t" << joint->limits->upper;
            }
            if (joint->mimic) {
                std::cout << "\tmimic\t" << joint->mimic->joint_name << "\t" << joint->mimic->multiplier << "\t"
                          << joint->mimic->offset;
            }
            std::cout << "\n";
        }
    }
}
