!> Planes, cylinders and cones within the chamber: distances, and parcels that bounce and roll, against closed formulas.
!> ranks: 1
program test_walls
  use chamber, only: chamber_t
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use des_scenes, only: put, run
  use kinds, only: wp
  use outcome, only: outcome_t, exit_failed
  use solids, only: solids_t
  use solids_statistics, only: statistics_t, find_statistics
  use wall_motion, only: cross
  use wall_scenes, only: material, room, plane, cylinder, cone, mass_of, column, g, tilt, level
  use wall_settings, only: wall_settings_t
  implicit none

  type(communicator_t) :: comm

  call start_ranks(comm)
  call shapes()
  call joined_rims()
  call like_a_face()
  call swing(friction=0.0_wp)
  call swing(friction=0.5_wp)
  call reflection_in_cylinder()
  call reflection_on_cone()
  call reflection_on_rim()
  call through(1)
  call through(2)
  call through(3)
  call finish()
  call stop_ranks()

contains

  !> Distances of points whose distance is known.
  subroutine shapes()
    type(chamber_t) :: chamber
    type(wall_settings_t) :: pipe
    real(wp), parameter :: origin(3) = [0.1_wp, 0.2_wp, 0.3_wp]
    real(wp) :: way(3), d

    pipe = cylinder(origin, 3*tilt, 0.04_wp)
    pipe%length = 0.05_wp
    call chamber%add_walls([plane(origin, 2*tilt), cylinder(origin, tilt, 0.04_wp), pipe, &
                            cone(origin, 0.01_wp, origin + 0.03_wp*tilt, 0.05_wp)])
    call expect_close(chamber%distance(7, origin + 0.02_wp*tilt + 0.3_wp*level), 0.02_wp, 1.0e-13_wp, 'distance from a plane')
    call expect_close(chamber%distance(8, origin + 0.9_wp*tilt + 0.03_wp*level), 0.01_wp, 1.0e-13_wp, 'from a cylinder, inside')
    call expect_close(chamber%distance(8, origin + 0.06_wp*level), -0.02_wp, 1.0e-13_wp, 'and outside')
    call expect_close(chamber%distance(9, origin + 0.02_wp*tilt + 0.06_wp*level), 0.02_wp, 1.0e-13_wp, 'from a pipe, outside')
    call expect_close(chamber%distance(9, origin + 0.08_wp*tilt + 0.08_wp*level), 0.05_wp, 1.0e-13_wp, 'from its far rim')
    call expect_close(chamber%distance(9, origin - 0.04_wp*tilt + 0.01_wp*level), 0.05_wp, 1.0e-13_wp, 'from its near rim')
    ! The generator goes 3 along and 4 away; from half way, 5 mm at right angles.
    call expect_close(chamber%distance(10, origin + 0.019_wp*tilt + 0.027_wp*level), 0.005_wp, 1.0e-13_wp, 'from a cone, inside')
    call expect_close(chamber%distance(10, origin + 0.011_wp*tilt + 0.033_wp*level), 0.005_wp, 1.0e-13_wp, 'and outside')
    call chamber%approach_shell(1, origin, way, d)
    call expect(abs(d - 0.04_wp) < 1.0e-15_wp .and. abs(norm2(way) - 0.04_wp) < 1.0e-15_wp .and. &
                abs(dot_product(way, tilt)) < 1.0e-15_wp, 'on its axis a cylinder is as far as anywhere')
  end subroutine shapes

  !> Where a cone goes over into a pipe one contact is felt, not two: on the rim they share by the edge, beside it by the
  !> wall that is nearer.
  subroutine joined_rims()
    type(chamber_t) :: chamber
    type(wall_settings_t) :: pipe
    real(wp) :: way(3), d(2), x(3), normal(3)
    real(wp), parameter :: foot(3) = [0.1_wp, 0.1_wp, 0.05_wp], out(3) = [1.0_wp, 0.0_wp, 0.0_wp], up(3) = [0.0_wp, 0.0_wp, 1.0_wp]

    pipe = cylinder(foot, -up, 0.02_wp)
    pipe%length = 0.05_wp
    call chamber%add_walls([pipe, cone(foot + 0.04_wp*up, 0.05_wp, foot, 0.02_wp)])
    ! Inside: the edge sticks out between the directions -out (of the pipe) and 0.6 up - 0.8 out (of the cone).
    normal = 0.3_wp*up - 0.9_wp*out
    x = foot + 0.02_wp*out + 0.004_wp*normal/norm2(normal)
    call chamber%approach_shell(1, x, way, d(1))
    call chamber%approach_shell(2, x, way, d(2))
    call expect_close(minval(d), 0.004_wp, 1.0e-12_wp, 'a shared rim is as far as it is')
    call expect(maxval(d) > 1.0_wp, 'and felt once')
    x = foot + 0.022_wp*out + 0.004_wp*up
    call chamber%approach_shell(1, x, way, d(1))
    call chamber%approach_shell(2, x, way, d(2))
    call expect(d(1) > 1.0_wp .and. d(2) < 0.005_wp, 'but not where the cone is nearer')
    ! Outside, in the corner, both walls are near.
    x = foot + 0.03_wp*out - 0.004_wp*up
    call chamber%approach_shell(1, x, way, d(1))
    call chamber%approach_shell(2, x, way, d(2))
    call expect(d(1) < 0.011_wp .and. d(2) < 0.011_wp, 'and a corner has two walls')
  end subroutine joined_rims

  !> On a plane in the place of the floor a ball does what it does on the floor, bit for bit.
  subroutine like_a_face()
    type(solids_t) :: floor, board
    type(statistics_t) :: s
    type(wall_settings_t) :: none(0)

    floor = room(comm, 0.02_wp, [0.5_wp, 0.2_wp, -g], material(2.0e3_wp, 0.3_wp, 0.3_wp), none)
    board = room(comm, 0.02_wp, [0.5_wp, 0.2_wp, -g], material(2.0e3_wp, 0.3_wp, 0.3_wp), &
                 [plane([0.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 0.0_wp, 1.0_wp])])
    board%chamber%open(1, 3) = .true.
    call put(floor, column([0.005_wp, 0.006_wp, 0.002_wp]), column([0.1_wp, 0.0_wp, 0.0_wp]), [1.0e-3_wp])
    call put(board, column([0.005_wp, 0.006_wp, 0.002_wp]), column([0.1_wp, 0.0_wp, 0.0_wp]), [1.0e-3_wp])
    call run(floor, 20000, floor%time_step_limit())
    call run(board, 20000, floor%time_step_limit())
    call expect(.not. any(abs(floor%parcels%state(:, 1) - board%parcels%state(:, 1)) > 0.0_wp), &
                'a plane in the place of the floor is the floor')
    s = find_statistics(board)
    call expect(s%wall_contacts == 1 .and. board%rebuilds > 5, 'and its contact is counted, over many lists')
  end subroutine like_a_face

  !> A ball swings in a lying pipe with the period 2 pi sqrt((R - r)/g) if it slides, 2 pi sqrt(7 (R - r)/(5 g)) if it rolls,
  !> times 1 + angle^2/16.
  subroutine swing(friction)
    real(wp), intent(in) :: friction

    real(wp), parameter :: wide = 0.05_wp, radius = 0.005_wp, angle = 0.02_wp, k = 1.0e5_wp
    real(wp), parameter :: centre(3) = [0.1_wp, 0.1_wp, 0.1_wp], along(3) = [0.6_wp, 0.8_wp, 0.0_wp]
    real(wp), parameter :: aside(3) = [0.8_wp, -0.6_wp, 0.0_wp], up(3) = [0.0_wp, 0.0_wp, 1.0_wp]
    type(solids_t) :: ball
    real(wp) :: sag, period, passed(2), before, now, dt
    integer :: n

    ball = room(comm, 0.2_wp, -g*up, material(k, 0.5_wp, friction), [cylinder(centre, along, wide)])
    sag = mass_of(2*radius)*g/k
    call put(ball, column(centre + (wide - radius + sag)*(sin(angle)*aside - cos(angle)*up)), column(0*up), [2*radius])
    dt = ball%time_step_limit()
    n = 0
    before = 1.0_wp
    do while (n < 2)
      call run(ball, 1, dt)
      now = dot_product(ball%parcels%state(1:3, 1) - centre, aside)
      if (now <= 0.0_wp .and. before > 0.0_wp) then
        n = n + 1
        passed(n) = ball%time + dt*now/(before - now)
      end if
      before = now
    end do
    period = 2*pi*sqrt((wide - radius)/g*merge(7.0_wp/5.0_wp, 1.0_wp, friction > 0.0_wp))*(1 + angle**2/16)
    call expect_close(passed(2) - passed(1), period, 1.0e-4_wp, 'a ball that '// &
                      trim(merge('rolls ', 'slides', friction > 0.0_wp))//' in a pipe swings with its period')
    call expect(abs(dot_product(ball%parcels%state(1:3, 1) - centre, along)) < 1.0e-9_wp, 'and stays where it is along the pipe')
  end subroutine swing

  !> Without friction a ball keeps its angular momentum about the axis, and a bounce off the inner wall is as off a mirror.
  subroutine reflection_in_cylinder()
    real(wp), parameter :: wide = 0.05_wp, radius = 0.002_wp
    real(wp), parameter :: centre(3) = [0.1_wp, 0.1_wp, 0.1_wp]
    real(wp) :: x(3), v(3), arm(3), before(3), after(3), normal(3)
    type(solids_t) :: ball

    ball = room(comm, 0.2_wp, 0*tilt, material(1.0e6_wp, 1.0_wp, 0.0_wp), [cylinder(centre, tilt, wide)])
    x = centre + 0.03_wp*level
    v = 0.3_wp*level + 0.4_wp*cross(tilt, level) + 0.2_wp*tilt
    call put(ball, column(x), column(v), [2*radius])
    before = cross(x - centre, v)
    call run(ball, nint(0.06_wp/norm2(v)/ball%time_step_limit()), ball%time_step_limit())
    arm = ball%parcels%state(1:3, 1) - centre
    after = cross(arm, ball%parcels%state(5:7, 1))
    ! From 30 mm out the way to the wall at 48 mm; there it is mirrored.
    normal = 0.03_wp*level + to_circle(0.03_wp, [0.3_wp, 0.4_wp], wide - radius)*(0.3_wp*level + 0.4_wp*cross(tilt, level))
    normal = normal/norm2(normal)
    call expect_close(dot_product(after, tilt), dot_product(before, tilt), 1.0e-10_wp, &
                      'a bounce in a cylinder keeps the angular momentum about its axis')
    call expect(norm2(ball%parcels%state(5:7, 1) - v + 2*dot_product(v, normal)*normal) < 1.0e-3_wp*norm2(v), &
                'and is as off a mirror')
    call expect(abs(dot_product(ball%parcels%state(5:7, 1) - v, normal)) > 0.5_wp, 'and there was one')
  end subroutine reflection_in_cylinder

  !> Time from (x, 0) at the given velocity to the circle of a radius about the origin.
  pure function to_circle(x, v, radius) result(t)
    real(wp), intent(in) :: x, v(2), radius
    real(wp) :: t

    t = (-x*v(1) + sqrt((x*v(1))**2 + sum(v**2)*(radius**2 - x**2)))/sum(v**2)
  end function to_circle

  !> Straight down onto a cone that goes 3 up and 4 out: mirrored about the normal (-3, 4)/5, times e along it.
  subroutine reflection_on_cone()
    real(wp), parameter :: radius = 0.002_wp, e = 0.8_wp, speed = 0.5_wp
    real(wp), parameter :: tip(3) = [0.1_wp, 0.1_wp, 0.05_wp], up(3) = [0.0_wp, 0.0_wp, 1.0_wp], out(3) = [0.6_wp, 0.8_wp, 0.0_wp]
    real(wp) :: normal(3), along(3), v(3)
    type(solids_t) :: ball

    ball = room(comm, 0.2_wp, 0*up, material(1.0e6_wp, e, 0.0_wp), [cone(tip, 0.0_wp, tip + 0.06_wp*up, 0.08_wp)])
    normal = 0.8_wp*up - 0.6_wp*out
    along = 0.6_wp*up + 0.8_wp*out
    call put(ball, column(tip + 0.04_wp*along + 1.001_wp*radius*normal), column(-speed*up), [2*radius])
    call run(ball, 1000, 0.05_wp*ball%time_step_limit())
    v = ball%parcels%state(5:7, 1)
    call expect_close(dot_product(v, along), -0.6_wp*speed, 1.0e-10_wp, 'a bounce on a cone keeps the velocity along it')
    call expect_close(dot_product(v, normal), e*0.8_wp*speed, 1.0e-3_wp, 'and returns e times that into it')
  end subroutine reflection_on_cone

  !> A ball falls on the rim of a standing pipe, from inside and from outside: the normal is the way from the rim.
  subroutine reflection_on_rim()
    real(wp), parameter :: wide = 0.05_wp, radius = 0.002_wp, speed = 0.5_wp
    real(wp), parameter :: foot(3) = [0.1_wp, 0.1_wp, 0.05_wp], up(3) = [0.0_wp, 0.0_wp, 1.0_wp], out(3) = [0.6_wp, 0.8_wp, 0.0_wp]
    type(wall_settings_t) :: pipe
    real(wp) :: normal(3), v(3), arm(3)
    type(solids_t) :: ball
    integer :: side

    pipe = cylinder(foot, up, wide)
    pipe%length = 0.05_wp
    do side = -1, 1, 2
      ball = room(comm, 0.2_wp, 0*up, material(1.0e8_wp, 1.0_wp, 0.0_wp), [pipe])
      normal = 0.8_wp*up + 0.6_wp*side*out
      call put(ball, column(foot + wide*out + 0.05_wp*up + 1.0001_wp*radius*normal), column(-speed*up), [2*radius])
      arm = ball%parcels%state(1:3, 1) - foot - wide*out - 0.05_wp*up
      call run(ball, 1000, 0.05_wp*ball%time_step_limit())
      v = ball%parcels%state(5:7, 1)
      call expect(norm2(v + speed*up - 1.6_wp*speed*normal) < 2.0e-3_wp*speed, 'a rim deflects a ball '// &
                  trim(merge('outward', 'inward ', side > 0)))
      call expect_close(norm2(cross(ball%parcels%state(1:3, 1) - foot - wide*out - 0.05_wp*up, v)), norm2(cross(arm, speed*up)), &
                        1.0e-10_wp, 'and keeps its angular momentum about the rim')
    end do
  end subroutine reflection_on_rim

  !> A parcel shot through a plane, a cylinder or a pipe with ends is not lost without a word.
  subroutine through(case)
    integer, intent(in) :: case

    type(wall_settings_t) :: walls(3)
    type(solids_t) :: ball
    type(outcome_t) :: outcome
    real(wp), parameter :: centre(3) = [0.01_wp, 0.01_wp, 0.01_wp]
    character(len=8), parameter :: names(3) = ['plane   ', 'cylinder', 'pipe    ']
    integer :: step

    walls = [plane(centre + 0.004_wp*level, -level), cylinder(centre, tilt, 0.004_wp), cylinder(centre, tilt, 0.004_wp)]
    walls(3)%length = 0.005_wp
    ball = room(comm, 0.02_wp, 0*tilt, material(20.0_wp, 0.9_wp, 0.3_wp), walls(case:case))
    call put(ball, column(centre + 0.002_wp*tilt), column(3.0_wp*level), [1.0e-3_wp])
    do step = 1, 400
      call ball%advance(1, ball%next_step_limit(), outcome)
      if (outcome%failed()) exit
    end do
    call expect(outcome%code == exit_failed .and. dot_product(ball%parcels%state(1:3, 1) - centre, level) > 0.0035_wp, &
                'a parcel through a '//trim(names(case))//' ends the run')
    if (outcome%failed()) call expect(index(outcome%message, 'parcel 1 at') > 0, 'it is named')
  end subroutine through

end program test_walls
