!> Surfaces of triangles and parcels that bounce, slide and rest on them, against planes and closed formulas.
!> ranks: 1
program test_mesh
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use contact_settings, only: contact_settings_t
  use des_scenes, only: put, run, cloud, softened
  use kinds, only: wp
  use mesh_scenes, only: mesh_room, mesh, sheet, box, ball, drum, turned
  use outcome, only: outcome_t, exit_failed
  use solids, only: solids_t
  use solids_statistics, only: statistics_t, find_statistics
  use surface, only: surface_t, new_surface
  use triangle, only: approach_triangle
  use wall_motion, only: wall_motion_t, cross
  use wall_scenes, only: material, room, plane, mass_of, column, g, tilt, level
  use wall_settings, only: wall_settings_t
  implicit none

  type(communicator_t) :: comm

  call start_ranks(comm)
  call nearest_points()
  call welding()
  call like_a_plane([1, 1], 0.0_wp, tilt)
  call like_a_plane([7, 9], 0.6_wp, tilt)
  call like_a_plane([60, 50], 0.8_wp, tilt)
  call like_a_plane([60, 50], 0.8_wp, [0.0_wp, 0.0_wp, 1.0_wp])
  call on_edges()
  call groove(0.5_wp*pi)
  call groove(2.0_wp*pi/3)
  call ridge()
  call tip()
  call closed_vessel('box   ')
  call closed_vessel('sphere')
  call turned_world()
  call through()
  call finish()
  call stop_ranks()

contains

  !> Distances to the face, the edges and the corners of a triangle.
  subroutine nearest_points()
    call look([2.0_wp, 2.0_wp, 3.0_wp], [0.0_wp, 0.0_wp, 2.0_wp], [0, 0], 'the face of a triangle')
    call look([2.0_wp, 2.0_wp, -1.0_wp], [0.0_wp, 0.0_wp, -2.0_wp], [0, 0], 'its other side')
    call look([3.0_wp, 0.5_wp, 2.0_wp], [0.0_wp, -0.5_wp, 1.0_wp], [1, 2], 'the edge ab')
    call look([0.0_wp, 2.0_wp, 0.0_wp], [-1.0_wp, 0.0_wp, -1.0_wp], [1, 3], 'the edge ac')
    call look([6.0_wp, 6.5_wp, 1.5_wp], [3.0_wp, 4.0_wp, 0.5_wp], [2, 3], 'the edge bc')
    call look([0.0_wp, 0.5_wp, 2.0_wp], [-1.0_wp, -0.5_wp, 1.0_wp], [1, 0], 'the corner a')
    call look([7.0_wp, 0.0_wp, 1.0_wp], [2.0_wp, -1.0_wp, 0.0_wp], [2, 0], 'the corner b')
    call look([0.0_wp, 6.0_wp, 4.0_wp], [-1.0_wp, 2.0_wp, 3.0_wp], [3, 0], 'the corner c')
  end subroutine nearest_points

  !> A triangle 4 along x and 3 along y.
  subroutine look(x, expected, bearing, name)
    real(wp), intent(in) :: x(3), expected(3)
    integer, intent(in) :: bearing(2)
    character(len=*), intent(in) :: name

    real(wp), parameter :: shape(3, 4) = reshape([1.0_wp, 1.0_wp, 1.0_wp, 5.0_wp, 1.0_wp, 1.0_wp, 1.0_wp, 4.0_wp, 1.0_wp, &
                                                  0.0_wp, 0.0_wp, 1.0_wp], [3, 4])
    real(wp) :: way(3)
    integer :: bearers(2)

    call approach_triangle(shape, x, way, bearers)
    call expect(norm2(way - expected) < 1.0e-14_wp .and. all(bearers == bearing), 'nearest: '//name)
  end subroutine look

  !> Corners that are one but for round-off are welded, triangles without an area left out, open edges found.
  subroutine welding()
    type(surface_t) :: surface
    real(wp), allocatable :: triangles(:,:,:)
    real(wp), parameter :: zero(3) = 0.0_wp, one(3) = 1.0_wp
    integer :: t, k

    allocate (triangles, source=box(zero, one, 4))
    do t = 1, size(triangles, 3)
      do k = 1, 3
        triangles(:, k, t) = triangles(:, k, t) + 1.0e-8_wp*modulo(7*t + k, 5)
      end do
    end do
    surface = new_surface(triangles)
    call expect(surface%n == 192 .and. size(surface%vertex, 2) == 98 .and. size(surface%open_edge, 2) == 0 .and. &
                surface%degenerate == 0, 'a box of 6 times 16 pieces has 98 corners and is closed')
    surface = new_surface(triangles(:, :, 2:))
    call expect(size(surface%open_edge, 2) == 3, 'without a triangle it has three open edges')
    associate (shown => sum(surface%vertex(:, surface%open_edge(:, 1)), 2))
      call expect(any([(norm2(shown - triangles(:, k, 1) - triangles(:, modulo(k, 3) + 1, 1)) < 2.0e-7_wp, k=1, 3)]), &
                  'one of which is shown')
    end associate
    ! A needle between two of its triangles, and a triangle that is a line.
    triangles = box(zero, one, 1)
    triangles(:, 3, 1) = 0.5_wp*(triangles(:, 1, 1) + triangles(:, 3, 1))
    triangles = reshape([triangles, triangles(:, 1, 2), triangles(:, 3, 1), triangles(:, 2, 2), &
                         triangles(:, 2, 1), triangles(:, 2, 2), triangles(:, 3, 1), &
                         triangles(:, 1, 5), triangles(:, 2, 5), triangles(:, 1, 5)], [3, 3, size(triangles, 3) + 3])
    surface = new_surface(triangles)
    call expect(size(surface%open_edge, 2) == 0 .and. surface%n == 13 .and. surface%degenerate == 2, &
                'triangles without an area are left out and leave no hole')
  end subroutine welding

  !> On a floor of triangles, whatever they are, a ball bounces, slides and rolls as on a plane: bit for bit if its height is
  !> a round number, else to the round-off of the places over an overlap.
  subroutine like_a_plane(n, jitter, up)
    integer, intent(in) :: n(2)
    real(wp), intent(in) :: jitter, up(3)

    real(wp), parameter :: middle(3) = 0.015625_wp, edge = 0.03125_wp
    type(solids_t) :: board, net
    type(statistics_t) :: s
    type(contact_settings_t) :: contact
    real(wp) :: a(3), b(3), start(3), way(3), apart
    integer :: part

    a = 0.025_wp*level
    b = 0.025_wp*cross(up, level)
    contact = material(2.0e3_wp, 0.7_wp, 0.3_wp)
    board = room(comm, edge, -g*up + 4*level, contact, [plane(middle, up)])
    net = mesh_room(comm, edge, -g*up + 4*level, contact, [mesh()], &
                    [new_surface(sheet(middle - 0.5_wp*(a + b), a, b, n, jitter))])
    start = middle - 0.4_wp*a - 0.1_wp*b + 0.8e-3_wp*up
    way = 0.1_wp*level + 0.03_wp*b/norm2(b)
    call put(board, column(start), column(way), [1.0e-3_wp])
    call put(net, column(start), column(way), [1.0e-3_wp])
    apart = 0.0_wp
    do part = 1, 60
      call run(board, 300, board%time_step_limit())
      call run(net, 300, board%time_step_limit())
      apart = max(apart, norm2(board%parcels%state(1:3, 1) - net%parcels%state(1:3, 1))/1.0e-3_wp, &
                  norm2(board%parcels%state(5:7, 1) - net%parcels%state(5:7, 1)), &
                  norm2(board%parcels%state(9:11, 1) - net%parcels%state(9:11, 1)))
      if (up(3) < 1.0_wp .and. part == 25) call expect_close(apart, 0.0_wp, 1.0e-10_wp, 'a ball bounces on triangles as on a plane')
    end do
    s = find_statistics(net)
    call expect(dot_product(net%parcels%state(1:3, 1) - start, level) > 5.0e-3_wp, 'a ball goes a long way over triangles')
    call expect(s%wall_contacts == 1 .and. net%rebuilds > 20, 'with one contact, over many lists')
    if (up(3) < 1.0_wp) call expect_close(apart, 0.0_wp, 1.0e-6_wp, 'and as on a plane')
    if (up(3) >= 1.0_wp) call expect(.not. apart > 0.0_wp, 'and as on a plane, bit for bit')
  end subroutine like_a_plane

  !> Straight above an edge or a corner of a plane there is one contact.
  subroutine on_edges()
    real(wp), parameter :: a(3) = 0.03_wp*level, up(3) = 0.49e-3_wp*tilt
    real(wp) :: corner(3), b(3)
    type(solids_t) :: net
    type(statistics_t) :: s

    b = 0.03_wp*cross(tilt, level)
    corner = 0.02_wp - 0.5_wp*(a + b)
    net = mesh_room(comm, 0.04_wp, -g*tilt, material(2.0e3_wp, 0.7_wp, 0.3_wp), [mesh()], &
                    [new_surface(sheet(corner, a, b, [2, 2], 0.0_wp))])
    call put(net, reshape([corner + 0.5_wp*(a + b) + up, corner + 0.5_wp*a + 0.7_wp*b + up, corner + 0.2_wp*(a + b) + up], &
                          [3, 3]), spread(0*a, 2, 3), [1.0e-3_wp, 1.0e-3_wp, 1.0e-3_wp])
    s = find_statistics(net)
    call expect(s%wall_contacts == 3, 'corners and edges of a plane bear once')
  end subroutine on_edges

  !> A ball at rest in a groove of an angle between its sides presses on each with m g/(2 sin(angle/2)).
  subroutine groove(angle)
    real(wp), intent(in) :: angle

    real(wp), parameter :: radius = 1.0e-3_wp, k = 1.0e4_wp, up(3) = [0.0_wp, 0.0_wp, 1.0_wp]
    real(wp) :: along(3), out(3), bottom(3), side(3, 2), height, dt, soft
    real(wp), allocatable :: triangles(:,:,:)
    type(solids_t) :: lump
    type(statistics_t) :: s
    integer :: m

    along = 0.02_wp*level
    out = cross(up, level)
    bottom = [0.02_wp, 0.02_wp, 0.01_wp] - 0.5_wp*along
    allocate (triangles(3, 3, 0))
    do m = 1, 2
      side(:, m) = 0.01_wp*(cos(0.5_wp*angle)*up + merge(1, -1, m == 1)*sin(0.5_wp*angle)*out)
      triangles = reshape([triangles, sheet(bottom, along, side(:, m), [6, 4], 0.5_wp)], [3, 3, size(triangles, 3) + 48])
    end do
    lump = mesh_room(comm, 0.04_wp, -g*up, material(k, 0.3_wp, 0.0_wp), [mesh()], [new_surface(triangles)])
    call put(lump, column(bottom + 0.43_wp*along + radius/sin(0.5_wp*angle)*up), column(0*up), [2*radius])
    dt = lump%time_step_limit()
    soft = softened(k, mass_of(2*radius), 0.3_wp, dt)
    height = (radius - mass_of(2*radius)*g/(2*sin(0.5_wp*angle)*soft))/sin(0.5_wp*angle)
    call run(lump, 20000, dt)
    s = find_statistics(lump)
    call expect(s%wall_contacts == 2, 'a ball in a groove touches both sides')
    call expect_close(lump%parcels%state(3, 1) - bottom(3), height, 1.0e-9_wp, 'and rests where they bear it')
    call expect_close(radius*s%max_overlap*soft, mass_of(2*radius)*g/(2*sin(0.5_wp*angle)), 1.0e-4_wp, 'with m g/(2 sin) on each')
  end subroutine groove

  !> A ball that falls on the ridge of a roof bounces off along the way from the ridge.
  subroutine ridge()
    real(wp), parameter :: radius = 2.0e-3_wp, speed = 0.5_wp, up(3) = [0.0_wp, 0.0_wp, 1.0_wp]
    real(wp) :: along(3), out(3), top(3), normal(3), v(3)
    type(solids_t) :: lump
    type(statistics_t) :: s

    along = 0.02_wp*level
    out = cross(up, level)
    top = [0.02_wp, 0.02_wp, 0.02_wp]
    lump = mesh_room(comm, 0.04_wp, 0*up, material(1.0e8_wp, 1.0_wp, 0.0_wp), [mesh()], &
                     [new_surface(reshape([sheet(top - 0.5_wp*along, along, 0.01_wp*(out - up), [5, 3], 0.3_wp), &
                                           sheet(top - 0.5_wp*along, along, -0.01_wp*(out + up), [5, 3], 0.3_wp)], [3, 3, 60]))])
    normal = 0.96_wp*up + 0.28_wp*out
    call put(lump, column(top + 0.037_wp*along + 0.999999_wp*radius*normal), column(-speed*up), [2*radius])
    s = find_statistics(lump)
    call expect(s%wall_contacts == 1, 'a ridge bears a ball once')
    call run(lump, 1000, 0.05_wp*lump%time_step_limit())
    v = lump%parcels%state(5:7, 1)
    call expect(norm2(v + speed*up - 2*0.96_wp*speed*normal) < 2.0e-3_wp*speed, 'and deflects it along the way from it')
  end subroutine ridge

  !> The same on the tip of a pyramid.
  subroutine tip()
    real(wp), parameter :: radius = 2.0e-3_wp, speed = 0.5_wp, up(3) = [0.0_wp, 0.0_wp, 1.0_wp]
    real(wp) :: top(3), foot(3, 4), normal(3), v(3)
    real(wp), allocatable :: triangles(:,:,:)
    type(solids_t) :: lump
    type(statistics_t) :: s
    integer :: k

    top = [0.02_wp, 0.02_wp, 0.02_wp]
    do k = 1, 4
      foot(:, k) = top - 0.01_wp*up + 0.01_wp*[cos(0.5_wp*pi*k), sin(0.5_wp*pi*k), 0.0_wp]
    end do
    triangles = reshape([(top, foot(:, k), foot(:, modulo(k, 4) + 1), k=1, 4)], [3, 3, 4])
    lump = mesh_room(comm, 0.04_wp, 0*up, material(1.0e8_wp, 1.0_wp, 0.0_wp), [mesh()], [new_surface(triangles)])
    normal = 0.96_wp*up + 0.28_wp*level
    call put(lump, column(top + 0.999999_wp*radius*normal), column(-speed*up), [2*radius])
    s = find_statistics(lump)
    call expect(s%wall_contacts == 1, 'a tip bears a ball once')
    call run(lump, 1000, 0.05_wp*lump%time_step_limit())
    v = lump%parcels%state(5:7, 1)
    call expect(norm2(v + speed*up - 2*0.96_wp*speed*normal) < 2.0e-3_wp*speed, 'and deflects it along the way from it')
  end subroutine tip

  !> A swarm without losses in a closed vessel: none gets out, and the energy stays.
  subroutine closed_vessel(kind)
    character(len=*), intent(in) :: kind

    real(wp), parameter :: centre(3) = [0.02_wp, 0.02_wp, 0.02_wp], wide = 0.008_wp
    type(solids_t) :: swarm
    type(statistics_t) :: before, after
    real(wp) :: most
    real(wp), allocatable :: x(:,:), v(:,:), diameter(:), triangles(:,:,:)
    real(wp) :: farthest
    integer :: i

    if (kind == 'box') then
      allocate (triangles, source=turned(box(centre - wide*0.75_wp, centre + wide*0.75_wp, 3), rotation(), centre))
    else
      allocate (triangles, source=ball(centre, wide, 8))
    end if
    swarm = mesh_room(comm, 0.04_wp, [0.0_wp, 0.0_wp, 0.0_wp], material(400.0_wp, 1.0_wp, 0.0_wp), [mesh()], &
                      [new_surface(triangles)])
    call cloud(200, centre - 3.1e-3_wp, 1.05e-3_wp, [6, 6], x, v, diameter)
    call put(swarm, x, v, 0.8_wp*diameter)
    before = find_statistics(swarm)
    most = 0.0_wp
    do i = 1, 10
      call run(swarm, 2000, swarm%time_step_limit())
      after = find_statistics(swarm)
      most = max(most, after%kinetic_energy)
    end do
    farthest = maxval([(norm2(swarm%parcels%state(1:3, i) - centre), i=1, swarm%parcels%n)])
    call expect(after%parcels == 200 .and. farthest < merge(sqrt(3.0_wp)*0.75_wp, 1.0_wp, kind == 'box')*wide, &
                'a closed '//trim(kind)//' loses no parcel')
    call expect_close(most, before%kinetic_energy, 2.0e-3_wp, 'and keeps their energy, which springs have but for moments')
  end subroutine closed_vessel

  pure function rotation() result(matrix)
    real(wp) :: matrix(3, 3)

    type(wall_motion_t) :: motion

    motion%spin = tilt
    matrix = motion%turn(0.7_wp)
  end function rotation

  !> Turn a vessel, what is in it and gravity, and the result is turned.
  subroutine turned_world()
    real(wp), parameter :: centre(3) = [0.02_wp, 0.02_wp, 0.02_wp]
    type(solids_t) :: here, there
    real(wp), allocatable :: x(:,:), v(:,:), diameter(:), triangles(:,:,:)
    real(wp) :: matrix(3, 3), down(3), apart, dt
    integer :: i

    matrix = rotation()
    down = [0.0_wp, 0.0_wp, -g]
    triangles = drum(centre - [0.0_wp, 0.006_wp, 0.0_wp], [0.0_wp, 0.012_wp, 0.0_wp], 0.008_wp, 24, 4, 0.003_wp)
    call cloud(12, centre - [2.0e-3_wp, 2.0e-3_wp, 3.0e-3_wp], 1.25e-3_wp, [3, 2], x, v, diameter)
    here = mesh_room(comm, 0.04_wp, down, material(500.0_wp, 0.6_wp, 0.4_wp), [mesh()], [new_surface(triangles)])
    there = mesh_room(comm, 0.04_wp, matmul(matrix, down), material(500.0_wp, 0.6_wp, 0.4_wp), [mesh()], &
                      [new_surface(turned(triangles, matrix, centre))])
    call put(here, x, v, diameter)
    call put(there, matmul(matrix, x - spread(centre, 2, 12)) + spread(centre, 2, 12), matmul(matrix, v), diameter)
    dt = here%time_step_limit()
    call run(here, 1500, dt)
    call run(there, 1500, dt)
    apart = 0.0_wp
    do i = 1, 12
      associate (a => here%parcels%state(1:3, findloc(here%parcels%id(:12), int(i, kind(here%parcels%id)), dim=1)) - centre, &
                 b => there%parcels%state(1:3, findloc(there%parcels%id(:12), int(i, kind(here%parcels%id)), dim=1)) - centre)
        apart = max(apart, norm2(matmul(matrix, a) - b))
      end associate
    end do
    call expect_close(apart, 0.0_wp, 1.0e-9_wp, 'a turned world is a turned world')
  end subroutine turned_world

  !> A parcel shot through a mesh is not lost without a word.
  subroutine through()
    type(solids_t) :: lump
    type(outcome_t) :: outcome
    real(wp), parameter :: centre(3) = [0.01_wp, 0.01_wp, 0.01_wp]
    integer :: step

    lump = mesh_room(comm, 0.02_wp, 0*tilt, material(20.0_wp, 0.9_wp, 0.3_wp), [mesh()], [new_surface(ball(centre, 0.004_wp, 5))])
    call put(lump, column(centre), column(3.0_wp*level), [1.0e-3_wp])
    do step = 1, 400
      call lump%advance(1, lump%next_step_limit(), outcome)
      if (outcome%failed()) exit
    end do
    call expect(outcome%code == exit_failed .and. norm2(lump%parcels%state(1:3, 1) - centre) < 0.00401_wp, &
                'a parcel through a mesh ends the run')
    if (outcome%failed()) call expect(index(outcome%message, 'parcel 1 at') > 0, 'it is named')
  end subroutine through

end program test_mesh
