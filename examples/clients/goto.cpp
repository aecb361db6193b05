// Drive a robot to a place and say how it goes: g++ -std=c++17 -o goto goto.cpp && ./goto HOST PORT X Y
// The protocol of the gateway with POSIX sockets alone. One message a line comes from the robot, so that a line is all there is to parse.

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

namespace {

constexpr int ttl_s = 3;
volatile std::sig_atomic_t is_interrupted = 0;

double now_s() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// The five entities that XML predefines, and ASCII by number: all that the robot writes.
std::string plain(const std::string& text) {
    static const std::map<std::string, std::string> entities = {{"lt", "<"}, {"gt", ">"}, {"amp", "&"}, {"quot", "\""}, {"apos", "'"}};
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const std::size_t end = text[i] == '&' ? text.find(';', i) : std::string::npos;
        if (end == std::string::npos) {
            out += text[i];
            continue;
        }
        const std::string name = text.substr(i + 1, end - i - 1);
        const auto known = entities.find(name);
        out += known != entities.end() ? known->second : std::string(1, static_cast<char>(std::atoi(name.c_str() + 1)));
        i = end;
    }
    return out;
}

// One message: its tag, its attributes, and what stands inside, as it stands.
struct Message {
    std::string tag, inside;
    std::map<std::string, std::string> attributes;

    explicit Message(const std::string& line) {
        std::size_t at = line.find_first_of(" />", 1);
        tag = line.substr(1, at - 1);
        while (line.at(at) == ' ') {
            const std::size_t equals = line.find("=\"", at), end = line.find('"', equals + 2);
            attributes[line.substr(at + 1, equals - at - 1)] = plain(line.substr(equals + 2, end - equals - 2));
            at = end + 1;
        }
        if (line.at(at) == '>') inside = line.substr(at + 1, line.rfind("</") - at - 1);
    }

    std::string attribute(const std::string& name) const {
        const auto found = attributes.find(name);
        return found == attributes.end() ? "" : found->second;
    }

    std::string child(const std::string& name) const {
        const std::size_t begin = inside.find("<" + name + ">"), end = inside.find("</" + name + ">");
        return begin == std::string::npos ? "" : inside.substr(begin + name.size() + 2, end - begin - name.size() - 2);
    }
};

class Robot {
public:
    Robot(const char* host, const char* port) {
        addrinfo hints{}, *found = nullptr;
        hints.ai_socktype = SOCK_STREAM;
        if (getaddrinfo(host, port, &hints, &found) != 0) throw std::runtime_error("no such address");
        for (const addrinfo* one = found; one != nullptr && socket_ < 0; one = one->ai_next) {
            socket_ = socket(one->ai_family, one->ai_socktype, one->ai_protocol);
            if (socket_ >= 0 && connect(socket_, one->ai_addr, one->ai_addrlen) != 0) {
                close(socket_);
                socket_ = -1;
            }
        }
        freeaddrinfo(found);
        if (socket_ < 0) throw std::runtime_error("no robot there");
        const int yes = 1;
        setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    }
    ~Robot() { close(socket_); }
    Robot(const Robot&) = delete;
    Robot& operator=(const Robot&) = delete;

    void say(std::string message) {
        message += '\n';
        for (std::size_t sent = 0; sent < message.size();) {
            const ssize_t count = send(socket_, message.data() + sent, message.size() - sent, MSG_NOSIGNAL);
            if (count < 0 && errno != EINTR) throw std::runtime_error("the connection is gone");
            if (count > 0) sent += static_cast<std::size_t>(count);
        }
    }

    // The next message; none if none comes in time, or a signal does.
    std::optional<Message> hear(double timeout_s) {
        for (std::size_t end; (end = buffer_.find('\n')) == std::string::npos;) {
            pollfd wait{socket_, POLLIN, 0};
            if (poll(&wait, 1, static_cast<int>(1000 * timeout_s)) <= 0) return std::nullopt;
            char bytes[65536];
            const ssize_t count = recv(socket_, bytes, sizeof bytes, 0);
            if (count <= 0) throw std::runtime_error("the robot closed the connection");
            buffer_.append(bytes, static_cast<std::size_t>(count));
        }
        const std::size_t end = buffer_.find('\n');
        Message message(buffer_.substr(0, end));
        buffer_.erase(0, end + 1);
        return message;
    }

private:
    int socket_ = -1;
    std::string buffer_;
};

// Give the lease back, and wait until that is heard: who leaves with the lease in hand stops the robot.
int let_go(Robot& robot, int code) {
    robot.say(R"(<lease id="release" op="release"/>)");
    for (auto heard = robot.hear(5.0); heard && heard->attribute("id") != "release"; heard = robot.hear(5.0)) {
    }
    return code;
}

int drive(Robot& robot, const std::string& goal) {
    robot.say(R"(<hello version="1.0" name="c++ example"/>)");
    robot.say(R"(<subscribe topic="Localization/Pose" max_rate_hz="2"/>)");
    robot.say(R"(<lease id="lease" op="acquire" ttl_s=")" + std::to_string(ttl_s) + R"(" on_loss="stop"/>)");
    double renewed_s = now_s();
    for (;;) {
        if (is_interrupted) {
            robot.say(R"(<stop id="stop"/>)");  // first of all
            is_interrupted = 0;
        }
        // The lease says: this program is alive. If it hangs or dies, the robot stops within ttl_s.
        if (now_s() - renewed_s > ttl_s / 3.0) {
            robot.say(R"(<lease op="renew" id="renew"/>)");
            renewed_s = now_s();
        }
        const auto heard = robot.hear(0.2);
        if (!heard) continue;
        if (heard->tag == "error" && heard->attribute("id") != "renew") {
            std::cerr << heard->attribute("code") << ": " << plain(heard->inside) << std::endl;
            return heard->attribute("fatal") == "true" ? 1 : let_go(robot, 1);
        }
        if (heard->attribute("id") == "lease") robot.say(R"(<run node="GoTo" goal=")" + goal + R"(" deadline_s="120"/>)");
        if (heard->attribute("id") == "stop") {
            std::cout << "stopped" << std::endl;
            return let_go(robot, 130);
        }
        if (heard->tag == "value") {
            double x = 0.0, y = 0.0;
            std::sscanf(heard->child("pose").c_str(), "%lf %lf", &x, &y);
            std::printf("pose %.2f %.2f\n", x, y);
            std::fflush(stdout);
        }
        if (heard->tag == "progress") std::cout << "progress " << heard->attribute("state") << ' ' << heard->attribute("text") << std::endl;
        if (heard->tag == "result") {
            std::cout << "result " << heard->attribute("state") << ' ' << heard->attribute("reason") << std::endl;
            return let_go(robot, heard->attribute("state") == "succeeded" ? 0 : 1);
        }
    }
}

/// Metres; nothing if the word is no number.
std::optional<double> metres(const char* word) {
    char* end = nullptr;
    const double value = std::strtod(word, &end);
    return end == word || *end != '\0' || !std::isfinite(value) ? std::nullopt : std::optional(value);
}

}  // namespace

int main(int count, char** words) {
    const auto x = count == 5 ? metres(words[3]) : std::nullopt, y = count == 5 ? metres(words[4]) : std::nullopt;
    if (!x || !y) {
        std::cerr << "usage: " << words[0] << " HOST PORT X Y, where X and Y are numbers, in metres" << std::endl;
        return 2;
    }
    struct sigaction interrupt{};
    interrupt.sa_handler = [](int) { is_interrupted = 1; };
    sigaction(SIGINT, &interrupt, nullptr);
    try {
        Robot robot(words[1], words[2]);
        return drive(robot, std::to_string(*x) + ";" + std::to_string(*y));
    } catch (const std::exception& error) {  // the connection, and with it the lease, is gone: the robot stops by itself
        std::cerr << error.what() << std::endl;
        return 1;
    }
}
