// Drive a robot to a place and say how it goes: java Goto.java HOST PORT X Y
// The protocol of the gateway with the JDK alone. One message a line comes from the robot; each line is parsed as a document of its own.

import java.io.BufferedReader;
import java.io.IOException;
import java.io.InputStreamReader;
import java.io.OutputStream;
import java.io.StringReader;
import java.net.Socket;
import java.nio.charset.StandardCharsets;
import java.util.Locale;
import java.util.concurrent.Executors;
import java.util.concurrent.ScheduledExecutorService;
import java.util.concurrent.TimeUnit;
import javax.xml.parsers.DocumentBuilder;
import javax.xml.parsers.DocumentBuilderFactory;
import org.w3c.dom.Element;
import org.xml.sax.InputSource;

public final class Goto {
    private static final int TTL_S = 3;

    private final Socket socket;
    private final BufferedReader lines;
    private final OutputStream out;
    private final DocumentBuilder parser;
    private volatile boolean isOver = false;

    private Goto(String host, int port) throws Exception {
        socket = new Socket(host, port);
        socket.setTcpNoDelay(true);
        lines = new BufferedReader(new InputStreamReader(socket.getInputStream(), StandardCharsets.UTF_8));
        out = socket.getOutputStream();
        DocumentBuilderFactory factory = DocumentBuilderFactory.newInstance();
        factory.setFeature("http://apache.org/xml/features/disallow-doctype-decl", true);
        parser = factory.newDocumentBuilder();
    }

    private synchronized void say(String message) throws IOException {
        out.write((message + "\n").getBytes(StandardCharsets.UTF_8));
        out.flush();
    }

    /** The next message; null at the end. */
    private Element hear() throws Exception {
        String line = lines.readLine();
        return line == null ? null : parser.parse(new InputSource(new StringReader(line))).getDocumentElement();
    }

    /** Say something and wait for its answer; what else comes meanwhile is shown. */
    private Element ask(String tag, String attributes) throws Exception {
        say("<" + tag + " id=\"" + tag + "\" " + attributes + "/>");
        for (Element heard; (heard = hear()) != null; show(heard)) {
            if (heard.getTagName().equals("error")) {
                letGo(); // refused: nothing moves because of us, and nothing is ours to stop
                throw new IOException(heard.getAttribute("code") + ": " + heard.getTextContent());
            }
            if (heard.getAttribute("id").equals(tag)) {
                return heard;
            }
        }
        throw new IOException("the robot closed the connection");
    }

    private static void show(Element heard) {
        if (heard.getTagName().equals("value")) {
            String[] pose = heard.getElementsByTagName("pose").item(0).getTextContent().split(" ");
            System.out.printf(Locale.ROOT, "pose %.2f %.2f%n", Double.parseDouble(pose[0]), Double.parseDouble(pose[1]));
        } else if (heard.getTagName().equals("progress")) {
            System.out.println("progress " + heard.getAttribute("state") + " " + heard.getAttribute("text"));
        }
    }

    private int drive(double x, double y) throws Exception {
        ask("hello", "version=\"1.0\" name=\"java example\"");
        ask("lease", "op=\"acquire\" ttl_s=\"" + TTL_S + "\" on_loss=\"stop\"");
        ScheduledExecutorService renewal = Executors.newSingleThreadScheduledExecutor(work -> {
            Thread thread = new Thread(work);
            thread.setDaemon(true);
            return thread;
        });
        renewal.scheduleAtFixedRate(this::renew, TTL_S * 1000 / 3, TTL_S * 1000 / 3, TimeUnit.MILLISECONDS);
        Runtime.getRuntime().addShutdownHook(new Thread(this::stop)); // Ctrl-C, and whatever else ends us too early
        ask("subscribe", "topic=\"Localization/Pose\" max_rate_hz=\"2\"");
        ask("run", String.format(Locale.ROOT, "node=\"GoTo\" goal=\"%s;%s\" deadline_s=\"120\"", x, y));
        for (Element heard; (heard = hear()) != null; show(heard)) {
            if (heard.getTagName().equals("result")) {
                renewal.shutdownNow();
                System.out.println("result " + heard.getAttribute("state") + " " + heard.getAttribute("reason"));
                letGo();
                return heard.getAttribute("state").equals("succeeded") ? 0 : 1;
            }
        }
        throw new IOException("the robot closed the connection");
    }

    /** Give the lease back, and wait until that is heard: who leaves with the lease in hand stops the robot. */
    private void letGo() throws Exception {
        isOver = true;
        say("<lease id=\"release\" op=\"release\"/>");
        for (Element heard = hear(); heard != null && !heard.getAttribute("id").equals("release"); heard = hear()) {
        }
    }

    /** The lease says: this program is alive. If it hangs or dies, the robot stops within TTL_S. */
    private void renew() {
        try {
            say("<lease op=\"renew\"/>");
        } catch (IOException error) {
            isOver = true; // no connection, no lease: the robot stops by itself
        }
    }

    private void stop() {
        try {
            if (!isOver) {
                say("<stop/>");
                System.out.println("stopped");
            }
        } catch (IOException error) {
            System.err.println("the stop was not heard: " + error.getMessage());
        }
    }

    private static boolean isNumber(String word) {
        try {
            return Double.isFinite(Double.parseDouble(word));
        } catch (NumberFormatException error) {
            return false;
        }
    }

    public static void main(String[] words) {
        if (words.length != 4 || !isNumber(words[2]) || !isNumber(words[3])) {
            System.err.println("usage: java Goto.java HOST PORT X Y, where X and Y are numbers, in metres");
            System.exit(2);
        }
        int code = 1;
        try {
            code = new Goto(words[0], Integer.parseInt(words[1])).drive(Double.parseDouble(words[2]), Double.parseDouble(words[3]));
        } catch (Exception error) {
            System.err.println(error.getMessage());
        }
        System.exit(code);
    }
}
