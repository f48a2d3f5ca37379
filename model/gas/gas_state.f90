!> Everything the gas equations work on.
!>
!> Staggered grid: pressure and void fraction in the cells, velocity component a on the faces across a. A face has
!> the index of the cell below it, so face (i,j,k) of component 1 lies between cells i and i+1, and index 0 is the
!> low face of the box. Fields are (-1:n1+2, -1:n2+2, -1:n3+2): two layers around the box of this rank. Beyond the
!> surface of the domain void fraction, drag and fluxes are zero, which makes the momentum balance of an open
!> face that of the half cell inside.
module gas_state
  use boundary_settings, only: boundary_settings_t
  use boxes, only: boxes_t
  use convection, only: limiter_index
  use free_levels, only: free_levels_t, one_level
  use gas_boundary, only: gas_boundary_t, new_gas_boundary
  use gas_numerics, only: gas_numerics_t
  use gas_parts, only: settle_parts
  use gas_settings, only: gas_settings_t
  use halo, only: halo_t, new_halo
  use kinds, only: wp
  use mesh, only: mesh_t, unit_step
  use momentum_solver, only: stencil_t, momentum_solver_t
  use open_space, only: open_space_t, let_slip
  use outcome, only: outcome_t
  use pressure_solver, only: pressure_solver_t
  implicit none
  private
  public :: gas_state_t, gas_report_t, wall_t, spacing_t, create_state, set_vents, vents, find_density, viscous_eps

  !> What the last step did. Mass flows are means over the step, over all ranks.
  type :: gas_report_t
    integer :: iterations = 0                !< SIMPLE iterations
    integer :: sweeps = 0                    !< momentum sweeps and gradient iterations
    integer :: pressure_iterations = 0       !< of the multigrid-preconditioned conjugate gradients
    real(wp) :: inflow = 0.0_wp              !< through inflow faces [kg/s]
    real(wp) :: outflow = 0.0_wp             !< net, through open faces [kg/s]
    real(wp) :: accumulation = 0.0_wp        !< growth of the gas mass in the domain [kg/s]
    real(wp) :: mass_scale = 0.0_wp          !< what mass residuals are compared with: the inflow if there is one [kg/s]
    real(wp) :: mass_imbalance = 0.0_wp      !< |inflow - outflow - accumulation| over that scale
    real(wp) :: mass_residual = 0.0_wp       !< sum of the cells' |imbalance| over that scale
    real(wp) :: momentum_residual = 0.0_wp   !< sum of the faces' |imbalance| over that of the forces
    real(wp) :: courant = 0.0_wp             !< largest |u| dt/h
  end type gas_report_t

  !> Friction on one side of the domain, of the faces of one component next to it.
  type :: wall_t
    real(wp), allocatable :: conductance(:,:,:)  !< eps mu A/h over the part where the gas sticks [kg/s]
  end type wall_t

  !> What a pressure drop of 1 Pa along a periodic direction adds to the gas: see driving.
  type :: response_t
    real(wp), allocatable :: velocity(:,:,:,:)  !< (face, a) [m/(s Pa)]
    real(wp), allocatable :: pressure(:,:,:)    !< [1]
    real(wp) :: flow(3)                         !< through the domain [kg/(s Pa)]
  end type response_t

  !> What drives the gas along periodic directions.
  type :: driving_t
    real(wp) :: drop(3) = 0.0_wp         !< by how much the pressure falls across the domain [Pa]
    real(wp) :: drop_before(3) = 0.0_wp  !< at the start of the step
    logical :: held(3) = .false.         !< whether the drop is found such that the flow is
    real(wp) :: flow(3) = 0.0_wp         !< this [kg/s]
    type(response_t) :: response(3)      !< to the drop along each direction that is held
  end type driving_t

  !> The grid along one direction, in cells of my box.
  type :: spacing_t
    real(wp), allocatable :: width(:)  !< (-1:n+2) of cells [m]
    real(wp), allocatable :: gap(:)    !< (-1:n+1) between the centres of a cell and the next one [m]
  end type spacing_t

  !> A density that follows the pressure: see gas_density.
  type :: ideal_gas_t
    real(wp) :: compressibility           !< psi, density over absolute pressure [kg/(m3 Pa)]
    real(wp) :: reference                 !< absolute pressure where the pressure is 0 [Pa]
    real(wp) :: dt                        !< length of the step [s]
    real(wp) :: least                     !< density of any cell of any rank [kg/m3]
    real(wp), allocatable :: density(:,:,:)   !< of cells, at the pressure at hand [kg/m3]
    real(wp), allocatable :: old(:,:,:)       !< and at the start of the step
    real(wp), allocatable :: face(:,:,:,:)    !< of faces [kg/m3]
    real(wp), allocatable :: capacity(:,:,:)  !< (n1,n2,n3) of a cell, eps V psi/(dt rho) [m3/(s Pa)]
    logical, allocatable :: by_mass(:)        !< (0:records) whether the mass flow of a &boundary is given
  end type ideal_gas_t

  !> Eddies smaller than the cells: see eddy_viscosity.
  type :: eddies_t
    real(wp) :: constant                       !< C_s [-]
    real(wp), allocatable :: viscosity(:,:,:)  !< (n1,n2,n3) mu_t of my cells in the last step, 0 before the first [Pa s]
    real(wp), allocatable :: eps(:,:,:)        !< of cells, eps (1 + mu_t/mu): stands for eps in the viscous stress [-]
  end type eddies_t

  type :: gas_state_t
    type(boxes_t) :: boxes
    type(mesh_t) :: mesh
    type(halo_t) :: halo
    type(open_space_t), allocatable :: space        !< exists if walls within the domain block the gas
    type(gas_boundary_t) :: boundary
    type(gas_numerics_t) :: numerics
    type(gas_report_t) :: report
    type(driving_t) :: driving
    type(ideal_gas_t), allocatable :: ideal         !< exists if the density varies
    type(eddies_t), allocatable :: eddies           !< exists if those smaller than the cells are modelled
    real(wp) :: time = 0.0_wp                       !< at the start of the step; its owner sets it where inflows change [s]
    real(wp) :: density                             !< of an ideal gas at the pressure of &gas [kg/m3]
    real(wp) :: viscosity                           !< dynamic [Pa s]
    real(wp) :: gravity(3) = 0.0_wp                 !< [m/s2]; its owner sets it before the first step
    integer :: limiter
    type(free_levels_t) :: levels                   !< where no pressure is given
    integer :: first(3, 3) = 1                      !< (b, a): first unknown of component a along b; 0 across the low side
    real(wp), allocatable :: eps(:,:,:)             !< void fraction at the end of the step [-]
    real(wp), allocatable :: eps_old(:,:,:)         !< and at its start
    real(wp), allocatable :: drag(:,:,:)            !< of a cell's particles, per velocity [kg/s]
    real(wp), allocatable :: drag_source(:,:,:,:)   !< (3,cell): their drag on a gas at rest [N]
    real(wp), allocatable :: velocity(:,:,:,:)      !< (face, a) in the voids [m/s]
    real(wp), allocatable :: pressure(:,:,:)        !< [Pa]
    real(wp), allocatable :: free(:,:,:,:)          !< (face, a): 1 where the velocity is solved for, 0 where given
    type(spacing_t) :: spacing(3)
    real(wp), allocatable :: volume(:,:,:)          !< of cells, as far as they are open; of closed ones all of it [m3]
    real(wp), allocatable :: passage(:,:,:,:)       !< void fraction times area of faces [m2]
    real(wp), allocatable :: seep(:,:,:)            !< mass flow into cells through their walls [kg/s]; exists if there is any
    real(wp) :: vented = 0.0_wp                     !< and out of those of my cells whose walls are outflows [kg/s]
    real(wp), allocatable :: storage(:,:,:)         !< growth of the gas mass of cells in the step, less seep [kg/s]
    real(wp), allocatable :: flux(:,:,:,:)          !< mass flow through faces [kg/s]
    real(wp), allocatable :: fixed(:,:,:,:)         !< diagonal without neighbours: inertia, drag, wall friction [kg/s]
    real(wp), allocatable :: source(:,:,:,:)        !< inertia, gravity, drag: what does not change in the step [N]
    real(wp), allocatable :: mobility(:,:,:,:)      !< velocity change per pressure difference, d_f [m/(s Pa)]
    real(wp), allocatable :: correction(:,:,:)      !< of the pressure [Pa]
    real(wp), allocatable :: imbalance(:,:,:)       !< mass: outflow + accumulation of each cell [kg/s]
    real(wp), allocatable :: forces(:,:,:,:)        !< drag and its source with halos, (cell, 4)
    real(wp), allocatable :: velocity_before(:,:,:,:), pressure_before(:,:,:)
    type(wall_t) :: wall(2, 3, 3)                   !< (end, across b, component a)
    type(stencil_t) :: stencil(3)
    type(momentum_solver_t) :: momentum
    type(pressure_solver_t) :: solver
  end type gas_state_t

contains

  !> A gas at its initial velocity in a domain without particles.
  subroutine create_state(boxes, mesh, settings, records, numerics, state, outcome, space)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    type(gas_settings_t), intent(in) :: settings
    type(boundary_settings_t), intent(in) :: records(:)
    type(gas_numerics_t), intent(in) :: numerics
    class(gas_state_t), intent(inout) :: state
    type(outcome_t), intent(inout) :: outcome
    type(open_space_t), intent(in), optional :: space  !< that walls leave

    integer :: a

    state%boxes = boxes
    state%mesh = mesh
    state%halo = new_halo(boxes)
    state%numerics = numerics
    state%density = settings%density
    state%viscosity = settings%viscosity
    state%driving%drop = settings%pressure_drop
    state%driving%held = settings%flow_given .and. mesh%periodic
    if (settings%flow_given) state%driving%flow = settings%mass_flow
    state%limiter = limiter_index(numerics%limiter)
    if (state%limiter < 0) error stop 'gas_state: the case reader let an unknown limiter pass'
    call new_gas_boundary(boxes, mesh, records, settings, state%boundary, outcome, space)
    if (outcome%failed()) return
    call allocate_fields(state, boxes%n)
    call set_spacing(state)
    call mark_faces(state)
    if (present(space)) then
      state%space = space
      call settle_parts(boxes, mesh, state%boundary, state%space, state%levels, outcome)
      if (outcome%failed()) return
      call narrow(state)
    else if (.not. state%boundary%any_open) then
      state%levels = one_level(boxes)
    end if
    do a = 1, 3
      state%velocity(:, :, :, a) = settings%velocity(a)*state%free(:, :, :, a)
    end do
    if (allocated(state%space)) call let_slide(state)
    state%pressure = settings%pressure
    call set_outer_pressure(state)
    call set_vents(state)
    if (settings%density_law == 'ideal') state%levels = free_levels_t()  ! its density gives it one
    if (allocated(state%space)) then
      call state%solver%create(boxes, state%levels, state%space%closed)
      if (vents(state)) call state%solver%hold(state%boundary%walls%vents)
    else
      call state%solver%create(boxes, state%levels)
    end if
  end subroutine create_state

  !> Whether gas leaves through walls within the domain, of any rank.
  pure function vents(state)
    class(gas_state_t), intent(in) :: state
    logical :: vents

    vents = allocated(state%boundary%walls)
    if (vents) vents = allocated(state%boundary%walls%vents)
  end function vents

  !> The pressure given where gas leaves through walls.
  subroutine set_vents(state)
    class(gas_state_t), intent(inout) :: state

    if (.not. vents(state)) return
    associate (n => state%boxes%n, walls => state%boundary%walls)
      where (walls%vents(1:n(1), 1:n(2), 1:n(3))) state%pressure(1:n(1), 1:n(2), 1:n(3)) = walls%pressure
    end associate
    call state%halo%exchange(state%pressure)
  end subroutine set_vents

  !> Leave to the gas what is open. The box of the domain is wall as far as its faces are open. The velocity on closed faces is that
  !> of the wall, where it moves: the limiter sees it.
  subroutine narrow(state)
    class(gas_state_t), intent(inout) :: state

    integer :: a, end, lo(3), hi(3), in(3)

    where (state%space%volume > 0.0_wp) state%volume = state%space%volume*state%volume
    where (.not. state%space%area > 0.0_wp) state%free = 0.0_wp
    if (allocated(state%boundary%walls)) then
      if (allocated(state%boundary%walls%slips)) call let_slip(state%boxes, state%boundary%walls%slips, state%space)
    end if
    do a = 1, 3
      do end = 1, 2
        associate (side => state%boundary%side(end, a), space => state%space)
          if (.not. side%mine) cycle
          lo = lbound(side%grip)
          hi = ubound(side%grip)
          in = merge(unit_step(a), [0, 0, 0], end == 1)
          side%grip = side%grip*space%area(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3), a) &
            /max(tiny(1.0_wp), space%volume(lo(1) + in(1):hi(1) + in(1), lo(2) + in(2):hi(2) + in(2), lo(3) + in(3):hi(3) + in(3)))
        end associate
      end do
    end do
  end subroutine narrow

  !> Give closed faces the velocity of the wall beside them.
  subroutine let_slide(state)
    class(gas_state_t), intent(inout) :: state

    if (.not. allocated(state%space%slide)) return
    where (.not. state%space%area > 0.0_wp) state%velocity = state%space%slide
    call state%halo%exchange_many(state%velocity)
  end subroutine let_slide

  subroutine allocate_fields(state, n)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: n(3)

    integer :: m(3)

    m = n + 2
    allocate (state%eps(-1:m(1), -1:m(2), -1:m(3)), source=0.0_wp)
    allocate (state%velocity(-1:m(1), -1:m(2), -1:m(3), 3), source=0.0_wp)
    allocate (state%drag_source(3, -1:m(1), -1:m(2), -1:m(3)), source=0.0_wp)
    allocate (state%forces(-1:m(1), -1:m(2), -1:m(3), 4), source=0.0_wp)
    allocate (state%drag, source=state%eps)
    allocate (state%pressure, source=state%eps)
    allocate (state%correction, source=state%eps)
    allocate (state%pressure_before, source=state%eps)
    allocate (state%free, source=state%velocity)
    allocate (state%passage, source=state%velocity)
    allocate (state%flux, source=state%velocity)
    allocate (state%fixed, source=state%velocity)
    allocate (state%source, source=state%velocity)
    allocate (state%mobility, source=state%velocity)
    allocate (state%velocity_before, source=state%velocity)
    allocate (state%imbalance(n(1), n(2), n(3)), source=0.0_wp)
    allocate (state%storage, source=state%imbalance)
    if (allocated(state%boundary%walls)) then
      if (state%boundary%walls%feed) allocate (state%seep, source=state%eps)
    end if
    state%eps(1:n(1), 1:n(2), 1:n(3)) = 1.0_wp
    call state%halo%exchange(state%eps)
    allocate (state%eps_old, source=state%eps)
  end subroutine allocate_fields

  !> What the equations want of the grid.
  subroutine set_spacing(state)
    class(gas_state_t), intent(inout) :: state

    integer :: a

    associate (lo => state%boxes%lo - 2, hi => state%boxes%hi + 2, n => state%boxes%n)
      do a = 1, 3
        allocate (state%spacing(a)%width(-1:n(a) + 2), source=state%mesh%axis(a)%width(lo(a):hi(a)))
        allocate (state%spacing(a)%gap(-1:n(a) + 1), source=state%mesh%axis(a)%gap(lo(a):hi(a) - 1))
      end do
      allocate (state%volume(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2), source=state%mesh%volumes(lo, hi))
    end associate
  end subroutine set_spacing

  !> Which faces are solved for: all within the domain, those on joined sides and the open ones.
  subroutine mark_faces(state)
    class(gas_state_t), intent(inout) :: state

    integer :: a, n(3)

    n = state%boxes%n
    do a = 1, 3
      state%free(1:n(1), 1:n(2), 1:n(3), a) = 1.0_wp
      if (state%boxes%at_low(a)) state%first(a, a) = 0
      call mark_side(state, a, 1)
      call mark_side(state, a, 2)
      if (.not. (state%boxes%periodic(a) .or. state%boxes%cells(a) > 1 .or. state%boundary%open_across(a))) cycle
      call state%stencil(a)%allocate_faces(state%first(:, a), n)
    end do
    call state%halo%exchange_many(state%free)
  end subroutine mark_faces

  subroutine mark_side(state, a, end)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a, end

    integer :: lo(3), hi(3)

    if (.not. state%boundary%side(end, a)%mine) return
    lo = 1
    hi = state%boxes%n
    lo(a) = merge(0, hi(a), end == 1)
    hi(a) = lo(a)
    state%free(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3), a) = &
      merge(1.0_wp, 0.0_wp, state%boundary%side(end, a)%open(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)))
  end subroutine mark_side

  !> The pressure given on open faces, kept in the layer beyond them.
  subroutine set_outer_pressure(state)
    class(gas_state_t), intent(inout) :: state

    integer :: a, end, lo(3), hi(3), beyond(3)

    do a = 1, 3
      do end = 1, 2
        associate (side => state%boundary%side(end, a))
          if (.not. side%mine) cycle
          lo = 1
          hi = state%boxes%n
          lo(a) = merge(0, hi(a), end == 1)
          hi(a) = lo(a)
          beyond = (end - 1)*unit_step(a)
          state%pressure(lo(1) + beyond(1):hi(1) + beyond(1), lo(2) + beyond(2):hi(2) + beyond(2), &
                         lo(3) + beyond(3):hi(3) + beyond(3)) = side%pressure(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3))
        end associate
      end do
    end do
  end subroutine set_outer_pressure

  !> The density of an ideal gas, in all cells, at the pressure at hand.
  pure subroutine find_density(state)
    class(gas_state_t), intent(inout) :: state

    state%ideal%density = state%ideal%compressibility*(state%ideal%reference + state%pressure)
  end subroutine find_density

  !> The void fraction of a cell as the viscous stress has it, times viscosity with eddies over that without [-].
  pure function viscous_eps(state, i, j, k) result(eps)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: i, j, k
    real(wp) :: eps

    if (allocated(state%eddies)) then
      eps = state%eddies%eps(i, j, k)
    else
      eps = state%eps(i, j, k)
    end if
  end function viscous_eps

end module gas_state
