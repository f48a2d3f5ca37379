!> Meshes that end on the faces of the domain or beyond: what they leave to the gas, and how it flows in through their rims.
! ranks: 1 2
! ranks in debug: 1
program test_open_mesh
  use blocking_walls, only: new_blocking_walls
  use boxes, only: boxes_t, new_boxes
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use gas, only: gas_t
  use gas_cases, only: scene_t, record, make_gas, steps
  use kinds, only: wp
  use mesh, only: mesh_t, new_uniform_mesh
  use mesh_rims, only: body_over, loose_rim, wall_within
  use mesh_scenes, only: drum, sheet, tube, mesh_wall => mesh
  use open_space, only: open_space_t, new_open_space
  use outcome, only: outcome_t
  use pipe_flow, only: pipe, pipe_flow_error
  use surface, only: surface_t, new_surface
  use wall_settings, only: wall_settings_t
  implicit none

  real(wp), parameter :: o = 0.0_wp, edge = 0.1_wp, radius = 0.04_wp, middle = 0.5_wp*edge + 0.0013_wp
  real(wp), parameter :: lower(3) = o, upper(3) = edge
  real(wp), parameter :: height = 0.02_wp
  integer, parameter :: segments = 24
  type(communicator_t) :: comm

  call start_ranks(comm)
  call tubes()
  call hopper()
  if (comm%is_root()) call rims()
  call flow()
  call inflow()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> In a box of 20 by 20 cells, 4 long in one direction.
  function space_of(surface, side, along) result(space)
    type(surface_t), intent(in) :: surface
    character(len=*), intent(in) :: side  !< where the gas is
    integer, intent(in) :: along
    type(open_space_t) :: space

    type(wall_settings_t) :: wall
    type(boxes_t) :: boxes
    type(mesh_t) :: grid
    type(outcome_t) :: outcome
    real(wp) :: high(3)
    integer :: cells(3)

    wall = mesh_wall()
    wall%gas_side = side
    high = upper
    high(along) = height
    cells = nint(high/edge*20)
    grid = new_uniform_mesh(lower, high, cells, [.false., .false., .false.])
    call new_boxes(comm, grid%n, grid%periodic, boxes, outcome)
    call new_open_space(boxes, grid, new_blocking_walls([wall], [surface], grid), space)
  end function space_of

  !> A tube 16 cells across along one axis or another: its ends on the faces, to the digits of a file of single precision, or
  !> beyond, cut straight or aslant, open or with lids.
  subroutine tubes()
    type(open_space_t) :: space
    type(surface_t) :: surface
    real(wp) :: start(3), axis(3), volume
    real(wp), allocatable :: triangles(:,:,:)
    integer :: a, kind

    volume = 0.5_wp*segments*sin(2*pi/segments)*radius**2*height
    do kind = 1, 5
      a = modulo(kind - 1, 3) + 1
      start = middle
      start(a) = merge(-0.3_wp*height, o, kind == 2 .or. kind == 4)
      axis = o
      axis(a) = merge(1.7_wp*height, height, kind == 2 .or. kind == 4)
      if (kind < 3) triangles = tube(start, axis, [radius, radius], segments)
      if (kind == 3 .or. kind == 4) triangles = drum(start, axis, radius, segments, 0, o)
      if (kind == 5) triangles = slanted(start, axis, a)
      if (kind /= 2) triangles = real(real(triangles), wp)
      surface = new_surface(triangles)
      space = space_of(surface, 'inside', a)
      if (comm%is_root()) call expect_close(space%open_volume, volume, 5.0e-3_wp, 'a tube from face to face')
      if (kind /= 1) cycle
      space = space_of(surface, 'outside', a)
      if (comm%is_root()) call expect_close(space%open_volume, edge**2*height - volume, 5.0e-3_wp, 'round a tube')
    end do
  end subroutine tubes

  !> A tube that is cut aslant beyond the upper face.
  function slanted(start, axis, a) result(triangles)
    real(wp), intent(in) :: start(3), axis(3)
    integer, intent(in) :: a
    real(wp) :: triangles(3, 3, 2*segments)

    integer :: t, k, b

    b = modulo(a, 3) + 1
    triangles = tube(start, axis, [radius, radius], segments)
    do t = 1, size(triangles, 3)
      do k = 1, 3
        if (triangles(a, k, t) > 0.5_wp*height) triangles(a, k, t) = height + 0.4_wp*(triangles(b, k, t) - middle + radius)
      end do
    end do
  end function slanted

  !> A cone from face to face.
  subroutine hopper()
    real(wp), parameter :: radii(2) = [0.025_wp, 0.045_wp]
    type(open_space_t) :: space
    real(wp) :: volume

    volume = 0.5_wp*segments*sin(2*pi/segments)*height*(radii(1)**2 + radii(1)*radii(2) + radii(2)**2)/3
    space = space_of(new_surface(tube([middle, o, middle], [o, height, o], radii, segments)), 'inside', 2)
    if (comm%is_root()) call expect_close(space%open_volume, volume, 5.0e-3_wp, 'a hopper from face to face')
  end subroutine hopper

  !> What is felt, what is closed, and what ends in the domain.
  subroutine rims()
    type(surface_t) :: surface, body
    real(wp) :: place(3)
    logical :: loose

    surface = new_surface(drum([middle, o, middle], [o, edge, o], radius, segments, 0, o))
    body = body_over(surface, lower, upper)
    call expect(body%n == surface%n, 'a drum is closed as it is')
    body = wall_within(surface, lower, upper)
    call expect(body%n == 2*segments, 'its lids on the faces are not felt')
    surface = new_surface(tube([middle, o, middle], [o, edge, o], [radius, radius], segments))
    call loose_rim(surface, lower, upper, loose, place)
    call expect(.not. loose, 'a tube from face to face has no loose rim')
    body = body_over(surface, lower, upper)
    call expect(body%n == 4*segments, 'cones close it')
    body = new_surface(reshape(body%vertex(:, reshape(body%corner, [3*body%n])), [3, 3, body%n]))
    call expect(size(body%open_edge, 2) == 0, 'and leave no edge')
    surface = new_surface(tube([middle, o, middle], [o, 0.9_wp*edge, o], [radius, radius], segments))
    call loose_rim(surface, lower, upper, loose, place)
    call expect(loose .and. abs(place(2) - 0.9_wp*edge) < 1.0e-9_wp, 'a tube that ends in the domain has one')
    surface = new_surface(tube([middle, o, o], [o, edge, o], [radius, radius], segments))
    call loose_rim(surface, lower, upper, loose, place)
    call expect(.not. loose, 'half of a tube in the domain')
    surface = new_surface(sheet([o, middle, o], [edge, o, o], [o, o, edge], [2, 2], o))
    call loose_rim(surface, lower, upper, loose, place)
    call expect(loose, 'a sheet from face to face has no inside')
  end subroutine rims

  !> Through a pipe of triangles as through a cylinder, but for its smaller section: the flow goes with the square of the area.
  subroutine flow()
    real(wp) :: error(2), imbalance, narrower
    logical :: ok(2)

    call pipe_flow_error(comm, 8, error(1), imbalance, ok(1))
    call pipe_flow_error(comm, 8, error(2), imbalance, ok(2), 96)
    narrower = (96/(2*pi)*sin(2*pi/96))**2
    if (.not. comm%is_root()) return
    call expect(all(ok) .and. imbalance < 1.0e-9_wp, 'flow through triangles')
    call expect_close((1 + error(2))/(1 + error(1)), narrower, 1.0e-3_wp, 'as through a cylinder')
  end subroutine flow

  !> What flows in through faces that walls cut is what is asked for, as a velocity, a volume and a mass, with a profile or not,
  !> and flows out.
  subroutine inflow()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: wanted
    integer :: m, shape
    logical :: converged

    do shape = 1, 2
      do m = 1, 3
        scene = scene_t(cells=[12, 8, 12], upper=[edge, edge, edge])
        scene%numerics%tolerance = 1.0e-11_wp
        scene%records = [record('in', 'inflow', lower, [edge, o, edge]), record('out', 'outflow', [o, edge, o], upper)]
        if (shape == 1) then
          scene%walls = [pipe([middle, o, middle], 2, radius)]
        else
          scene%walls = [mesh_wall()]
          scene%surfaces = [new_surface(tube([middle, o, middle], [o, edge, o], [0.03_wp, radius], segments))]
        end if
        scene%walls%gas_side = 'inside'
        wanted = 1.2e-4_wp
        if (m == 1) scene%records(1)%volume_flow = 1.0e-4_wp
        if (m > 1) scene%records(1)%mass_flow = wanted
        if (m == 3) scene%records(1)%profile = 'parabola'
        call make_gas(comm, scene, gas, outcome)
        call gas%advance(1.0e-3_wp, converged)
        if (comm%is_root()) then
          call expect(converged, 'a cut inflow converges')
          call expect_close(gas%report%inflow, wanted, 1.0e-13_wp, 'a cut inflow is what is asked for [kg/s]')
          call expect_close(gas%report%outflow, wanted, 1.0e-10_wp, 'and leaves [kg/s]')
          call expect_close(1.2_wp*gas%boundary%inflow, wanted, 1.0e-13_wp, 'it is known [kg/s]')
        end if
        call gas%destroy()
      end do
    end do
  end subroutine inflow

end program test_open_mesh
