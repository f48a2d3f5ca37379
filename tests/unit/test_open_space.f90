!> How walls cut cells: volumes, areas, walls of cylinders, cones and meshes.
! ranks in debug: 1
program test_open_space
  use blocking_walls, only: new_blocking_walls
  use boxes, only: boxes_t, new_boxes
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use grid_axis, only: graded_axis, graded_faces
  use kinds, only: wp
  use mesh, only: mesh_t, new_mesh, new_uniform_mesh
  use mesh_scenes, only: ball, drum, mesh_wall => mesh
  use open_space, only: open_space_t, new_open_space
  use outcome, only: outcome_t
  use pipe_flow, only: pipe, pipe_flow_error
  use surface, only: surface_t, new_surface
  use wall_motion, only: cross
  use wall_settings, only: wall_settings_t
  implicit none

  real(wp), parameter :: edge = 0.1_wp, middle(3) = 0.5_wp*edge + [0.0013_wp, 0.0_wp, -0.0007_wp]
  type(communicator_t) :: comm

  call start_ranks(comm)
  call cylinders()
  call vessel()
  call meshes()
  call nothing()
  call pipes()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> A cube of n cells along each edge, or twice as fine in the middle.
  function cube(n, graded) result(grid)
    integer, intent(in) :: n
    logical, intent(in) :: graded
    type(mesh_t) :: grid

    integer :: a

    if (.not. graded) grid = new_uniform_mesh([0.0_wp, 0.0_wp, 0.0_wp], [edge, edge, edge], [n, n, n], [.false., .false., .false.])
    if (graded) grid = new_mesh([(graded_axis(graded_faces([0.0_wp, 0.5_wp*edge, edge], [n/2, n/2], [0.5_wp, 2.0_wp]), .false.), &
                                  a=1, 3)])
  end function cube

  function space_of(grid, walls, surfaces) result(space)
    type(mesh_t), intent(in) :: grid
    type(wall_settings_t), intent(in) :: walls(:)
    type(surface_t), intent(in), optional :: surfaces(:)
    type(open_space_t) :: space

    type(boxes_t) :: boxes
    type(outcome_t) :: outcome
    type(surface_t), allocatable :: none(:)

    allocate (none(size(walls)))
    call new_boxes(comm, grid%n, grid%periodic, boxes, outcome)
    if (present(surfaces)) call new_open_space(boxes, grid, new_blocking_walls(walls, surfaces, grid), space)
    if (.not. present(surfaces)) call new_open_space(boxes, grid, new_blocking_walls(walls, none, grid), space)
    call check_faces(boxes, grid, space)
  end function space_of

  !> The walls of all cells, as a sum of vectors, close the open faces of the domain: nothing is left over in a cell, and
  !> closed cells have no open face.
  subroutine check_faces(boxes, grid, space)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: grid
    type(open_space_t), intent(in) :: space

    integer :: i, j, k
    real(wp) :: worst

    worst = 0.0_wp
    do k = 1, boxes%n(3)
      do j = 1, boxes%n(2)
        do i = 1, boxes%n(1)
          if (.not. space%closed(i, j, k)) cycle
          worst = max(worst, space%volume(i, j, k), maxval(space%area(i, j, k, :)), space%area(i - 1, j, k, 1), &
                      space%area(i, j - 1, k, 2), space%area(i, j, k - 1, 3))
        end do
      end do
    end do
    worst = comm%max(worst)
    if (comm%is_root()) call expect(.not. worst > 0.0_wp, 'closed cells have no open face')
    if (comm%is_root()) call expect(space%lost_volume < 2.0e-3_wp*product(grid%upper - grid%lower), 'little is lost')
  end subroutine check_faces

  !> Along each axis, on equal and on graded cells, inside and outside; some of them on finer cells, too.
  subroutine cylinders()
    type(open_space_t) :: space
    type(wall_settings_t) :: wall
    real(wp) :: volume
    integer :: a, n, side, m

    do a = 1, 3
      do side = 1, 2
        do m = 1, 2
          n = 16
          wall = pipe(cshift(middle, 1 - a), a, 0.04_wp)
          if (side == 2) wall%gas_side = 'outside'
          volume = pi*wall%radius**2*edge
          if (side == 2) volume = edge**3 - volume
          space = space_of(cube(n, m == 2), [wall])
          if (comm%is_root()) call expect_close(space%open_volume, volume, 3.0e-3_wp, 'cylinder')
          if (modulo(a + side + m, 3) /= 0) cycle
          space = space_of(cube(2*n, m == 2), [wall])
          if (comm%is_root()) call expect_close(space%open_volume, volume, 2.0e-3_wp, 'cylinder, finer')
        end do
      end do
    end do
  end subroutine cylinders

  !> A cylinder on a cone that ends on the floor, as one vessel; a slanted plane.
  subroutine vessel()
    type(open_space_t) :: space
    type(wall_settings_t) :: walls(2)
    real(wp) :: floor, volume
    type(boxes_t) :: boxes
    type(outcome_t) :: outcome
    type(mesh_t) :: grid

    walls(1)%kind = 'cone'
    walls(1)%point = [middle(1), 0.0_wp, middle(3)]
    walls(1)%end_point = [middle(1), 0.5_wp*edge, middle(3)]
    walls(1)%radius = 0.015_wp
    walls(1)%end_radius = 0.045_wp
    walls(2) = pipe([middle(1), 0.5_wp*edge, middle(3)], 2, 0.045_wp)
    walls(2)%length = 0.5_wp*edge
    walls%gas_side = 'inside'
    volume = pi*0.05_wp/3*(0.015_wp**2 + 0.015_wp*0.045_wp + 0.045_wp**2) + pi*0.045_wp**2*0.05_wp
    grid = cube(18, .false.)
    call new_boxes(comm, grid%n, grid%periodic, boxes, outcome)
    space = space_of(grid, walls)
    floor = 0.0_wp
    if (boxes%at_low(2)) floor = sum(space%area(1:boxes%n(1), 0, 1:boxes%n(3), 2))*(edge/18)**2
    floor = comm%sum(floor)
    if (comm%is_root()) call expect_close(space%open_volume, volume, 5.0e-3_wp, 'cylinder on cone')
    if (comm%is_root()) call expect_close(floor, pi*0.015_wp**2, 2.0e-2_wp, 'the floor of the cone')
    walls(1)%gas_side = 'outside'
    space = space_of(grid, walls(1:1))
    volume = edge**3 - pi*0.05_wp/3*(0.015_wp**2 + 0.015_wp*0.045_wp + 0.045_wp**2)
    if (comm%is_root()) call expect_close(space%open_volume, volume, 5.0e-3_wp, 'round a cone')
    walls(1)%kind = 'plane'
    walls(1)%point = 0.5_wp*edge
    walls(1)%normal = [1.0_wp, -2.0_wp, 0.4_wp]
    walls(1)%gas_side = 'inside'
    space = space_of(cube(16, .true.), walls(1:1))
    if (comm%is_root()) call expect_close(space%open_volume, 0.5_wp*edge**3, 1.0e-3_wp, 'half a cube')
    call plane_walls(space)
  end subroutine vessel

  !> The wall in the cells of the slanted plane: y = ((x - c) + 0.4 (z - c))/2 + c leaves the cube through its sides only.
  subroutine plane_walls(space)
    type(open_space_t), intent(in) :: space

    real(wp) :: wall

    associate (n => shape(space%closed))
      wall = comm%sum(sum(space%wall(1:n(1), 1:n(2), 1:n(3))))
    end associate
    if (comm%is_root()) call expect_close(wall, edge**2*sqrt(1 + 0.25_wp + 0.04_wp), 2.0e-2_wp, 'area of a plane')
  end subroutine plane_walls

  !> A ball and a drum of triangles, against their own volumes.
  subroutine meshes()
    type(open_space_t) :: space
    type(wall_settings_t) :: wall
    type(surface_t) :: surfaces(1)
    real(wp) :: volume

    wall = mesh_wall()
    wall%gas_side = 'inside'
    surfaces(1) = new_surface(ball(middle, 0.04_wp, 5))
    volume = volume_of(surfaces(1), middle)
    space = space_of(cube(20, .false.), [wall], surfaces)
    if (comm%is_root()) call expect_close(space%open_volume, volume, 5.0e-3_wp, 'in a ball')
    wall%gas_side = 'outside'
    space = space_of(cube(14, .true.), [wall], surfaces)
    if (comm%is_root()) call expect_close(space%open_volume, edge**3 - volume, 5.0e-3_wp, 'round a ball')
  end subroutine meshes

  !> Of what a surface encloses, all of which can be seen from a point [m3].
  function volume_of(surface, point) result(volume)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in) :: point(3)  !< [m]
    real(wp) :: volume

    integer :: t

    volume = 0.0_wp
    do t = 1, surface%n
      associate (a => surface%vertex(:, surface%corner(1, t)) - point, b => surface%vertex(:, surface%corner(2, t)) - point, &
                 c => surface%vertex(:, surface%corner(3, t)) - point)
        volume = volume + abs(dot_product(a, cross(b, c)))/6
      end associate
    end do
  end function volume_of

  !> Walls that leave nothing.
  subroutine nothing()
    type(open_space_t) :: space

    space = space_of(cube(8, .false.), [pipe(middle, 1, 1.0e-5_wp)])
    if (comm%is_root()) call expect(all(space%first_open == 0), 'no cell is open')
  end subroutine nothing

  !> The flow through a pipe, to second order, its mass to round-off.
  subroutine pipes()
    real(wp) :: error(3), imbalance
    logical :: ok
    integer :: level

    do level = 1, 3
      call pipe_flow_error(comm, 4*2**level, error(level), imbalance, ok)
      if (.not. comm%is_root()) cycle
      call expect(ok, 'the pipe converges')
      call expect(imbalance < 1.0e-9_wp, 'its mass balances')
    end do
    if (.not. comm%is_root()) return
    call expect_close(error(3), 0.0_wp, 3.2e-3_wp, 'flow through a pipe of 32 cells')
    call expect(error(2) < 0.3_wp*error(1) .and. error(3) < 0.3_wp*error(2), 'flow through a pipe, second order')
  end subroutine pipes

end program test_open_space
