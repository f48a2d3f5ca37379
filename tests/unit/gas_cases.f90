!> Small gas problems for the unit tests.
module gas_cases
  use blocking_walls, only: new_blocking_walls
  use boundary_settings, only: boundary_settings_t
  use boxes, only: boxes_t, new_boxes
  use communicator, only: communicator_t
  use gas, only: gas_t, new_gas
  use gas_numerics, only: gas_numerics_t
  use gas_settings, only: gas_settings_t
  use grid_axis, only: axis_t
  use kinds, only: wp
  use mesh, only: mesh_t, new_mesh, new_uniform_mesh
  use open_space, only: open_space_t, new_open_space
  use outcome, only: outcome_t
  use surface, only: surface_t
  use wall_settings, only: wall_settings_t
  implicit none
  private
  public :: scene_t, record, channel, make_gas, set_cells, steps
  public :: wavy_void, uneven_drag, flat_void, flat_drag, slug_drag, slug_source

  !> What a test chooses; the rest has defaults.
  type :: scene_t
    real(wp) :: upper(3) = 1.0_wp
    integer :: cells(3) = 1
    type(axis_t), allocatable :: axis(:)  !< in place of equal cells
    logical :: periodic(3) = .false.
    real(wp) :: gravity(3) = 0.0_wp
    type(gas_settings_t) :: settings
    type(gas_numerics_t) :: numerics
    type(boundary_settings_t), allocatable :: records(:)
    type(wall_settings_t), allocatable :: walls(:)  !< that block the gas
    type(surface_t), allocatable :: surfaces(:)     !< (walls) of those that are meshes; may miss if none is
  end type scene_t

contains

  function record(id, kind, lower, upper, velocity, pressure) result(r)
    character(len=*), intent(in) :: id, kind
    real(wp), intent(in) :: lower(3), upper(3)
    real(wp), intent(in), optional :: velocity, pressure
    type(boundary_settings_t) :: r

    r%id = id
    r%kind = kind
    r%lower = lower
    r%upper = upper
    if (present(velocity)) r%velocity = velocity
    if (present(pressure)) r%pressure = pressure
  end function record

  !> A channel along y with slip sides, an inflow below and an outflow above.
  function channel(edge) result(scene)
    real(wp), intent(in) :: edge  !< of a cell [m]
    type(scene_t) :: scene

    real(wp), parameter :: o = 0.0_wp

    scene%cells = [8, 6, 4]
    scene%upper = scene%cells*edge
    scene%periodic = [.false., .false., .true.]
    allocate (scene%records(2))
    associate (top => scene%upper)
      scene%records(1) = record('in', 'inflow', [o, o, o], [top(1), o, top(3)], velocity=0.5_wp)
      scene%records(2) = record('out', 'outflow', [o, top(2), o], top)
    end associate
  end function channel

  subroutine make_gas(comm, scene, gas, outcome)
    type(communicator_t), intent(in) :: comm
    type(scene_t), intent(in) :: scene
    type(gas_t), intent(out) :: gas
    type(outcome_t), intent(inout) :: outcome

    type(boxes_t) :: boxes
    type(mesh_t) :: mesh
    type(open_space_t), allocatable :: space
    type(surface_t), allocatable :: surfaces(:)

    mesh = new_uniform_mesh([0.0_wp, 0.0_wp, 0.0_wp], scene%upper, scene%cells, scene%periodic)
    if (allocated(scene%axis)) mesh = new_mesh(scene%axis)
    call new_boxes(comm, scene%cells, scene%periodic, boxes, outcome)
    if (outcome%failed()) return
    if (allocated(scene%walls)) then
      allocate (space, surfaces(size(scene%walls)))
      if (allocated(scene%surfaces)) surfaces = scene%surfaces
      call new_open_space(boxes, mesh, new_blocking_walls(scene%walls, surfaces, mesh), space)
    end if
    call new_gas(boxes, mesh, scene%settings, scene%records, scene%numerics, gas, outcome, space)
    if (outcome%failed()) return
    gas%gravity = scene%gravity
    call gas%accept()
  end subroutine make_gas

  !> Set a cell field of the box from a function of the cell's place in the whole grid.
  subroutine set_cells(boxes, value, field)
    interface
      pure function value(cell) result(x)
        import :: wp
        implicit none
        integer, intent(in) :: cell(3)
        real(wp) :: x
      end function value
    end interface
    type(boxes_t), intent(in) :: boxes
    real(wp), intent(inout), contiguous :: field(-1:, -1:, -1:)

    integer :: i, j, k

    do k = 1, boxes%n(3)
      do j = 1, boxes%n(2)
        do i = 1, boxes%n(1)
          field(i, j, k) = value(boxes%lo + [i, j, k] - 1)
        end do
      end do
    end do
  end subroutine set_cells

  !> So many steps with the same inputs; whether all converged.
  function steps(gas, count, dt) result(ok)
    type(gas_t), intent(inout) :: gas
    integer, intent(in) :: count
    real(wp), intent(in) :: dt
    logical :: ok

    integer :: step
    logical :: converged

    ok = .true.
    do step = 1, count
      call gas%advance(dt, converged)
      ok = ok .and. converged
      call gas%accept()
    end do
  end function steps

  pure function wavy_void(cell) result(eps)
    integer, intent(in) :: cell(3)
    real(wp) :: eps

    eps = 0.7_wp + 0.25_wp*sin(0.5_wp*cell(2))
  end function wavy_void

  pure function uneven_drag(cell) result(drag)
    integer, intent(in) :: cell(3)
    real(wp) :: drag

    drag = 1.0e-4_wp*(1.1_wp + sin(1.3_wp*cell(1) + 0.7_wp*cell(2) + 2.1_wp*cell(3)))
  end function uneven_drag

  pure function flat_void(cell) result(eps)
    integer, intent(in) :: cell(3)
    real(wp) :: eps

    eps = 0.7_wp + 0.2_wp*sin(0.8_wp*cell(1))*cos(0.5_wp*cell(2))
  end function flat_void

  pure function flat_drag(cell) result(drag)
    integer, intent(in) :: cell(3)
    real(wp) :: drag

    drag = 2.0e-4_wp*(1.1_wp + sin(1.7_wp*cell(1) + 0.3_wp*cell(2)))
  end function flat_drag

  !> Dense in the top four rows.
  pure function slug_drag(cell) result(drag)
    integer, intent(in) :: cell(3)
    real(wp) :: drag

    drag = merge(2.0e-4_wp, 3.0e-5_wp, cell(2) > 16)
  end function slug_drag

  !> There one side falls at 2 m/s and the other rises.
  pure function slug_source(cell) result(source)
    integer, intent(in) :: cell(3)
    real(wp) :: source

    source = slug_drag(cell)*merge(merge(-2.0_wp, 2.0_wp, cell(1) > 4), 0.0_wp, cell(2) > 16)
  end function slug_source

end module gas_cases
