!> Everything that is simulated, and how it takes one step: the gas, the parcels, and what they do to each other.
!>
!> A gas step from t to t + dt:
!>   1. the void fraction and the drag of the parcels where they are, for a step of dt;
!>   2. the gas, implicitly, until it converges: otherwise again from the same state with half the step (step_control);
!>   3. the force of the gas on the parcels, exactly what the gas has felt, constant over the step;
!>   4. the parcels, in as many equal solids steps as their shortest collision or their speed ask for.
!> So the gas sees the void fraction change one step after the parcels have moved. Where the step becomes shorter
!> than the time the parcels have moved unseen, it sees that share of the change, and the rest in the next steps:
!> the rate of change stays what it was, and no gas volume is lost.
module scene
  use blocking_walls, only: blocking_walls_t, new_blocking_walls
  use boxes, only: boxes_t, new_boxes
  use case, only: case_t
  use communicator, only: communicator_t
  use coupling, only: coupling_t
  use enclosure, only: enclosure_of
  use gas, only: gas_t, new_gas
  use kinds, only: wp, i8
  use mesh, only: mesh_t, new_mesh, new_uniform_mesh
  use open_space, only: open_space_t, new_open_space
  use outcome, only: outcome_t, exit_failed, exit_input
  use solids, only: solids_t
  use step_control, only: step_limits_t, step_taken_t, step_limits_of, plan_step
  use text, only: brief, shown
  use timing, only: stopwatch_t
  implicit none
  private
  public :: scene_t, step_report_t, parts, part_coupling, part_gas, part_parcels, part_output

  integer, parameter :: part_coupling = 1, part_gas = 2, part_parcels = 3, part_output = 4
  character(len=8), parameter :: parts(4) = ['coupling', 'gas     ', 'parcels ', 'output  ']

  real(wp), parameter :: round_off = 1.0e-6_wp  !< by which the last step may be too long, relative

  !> What the last step was like.
  type :: step_report_t
    real(wp) :: dt = 0        !< of the gas [s]
    integer :: retries = 0    !< how often the step was halved
    integer :: solids_steps = 0
  end type step_report_t

  type :: scene_t
    type(communicator_t) :: comm
    logical :: with_gas = .false., with_parcels = .false.
    type(step_limits_t) :: limits       !< of the gas step
    type(mesh_t) :: mesh                !< of the gas; without one, of regions in which parcels are looked at
    type(boxes_t) :: boxes              !< with a gas; so is the gas itself
    type(gas_t) :: gas
    type(solids_t) :: solids            !< with parcels
    type(coupling_t) :: coupling        !< with both
    real(wp) :: time = 0                !< [s]
    integer(i8) :: steps = 0            !< of the gas, since the start of the run
    integer :: halvings = 0             !< the next step is limits%longest/2**halvings
    integer :: good_steps = 0           !< without a retry, in a row: see step_control
    real(wp) :: unseen = 0              !< time the parcels have moved without the gas seeing it [s]
    logical :: begun = .false.          !< whether the gas has met the parcels
    logical :: astray = .false.         !< whether a step has failed after the parcels had begun to move
    type(step_report_t) :: report
    type(stopwatch_t) :: watch
    real(wp), allocatable :: mapped(:,:,:)  !< void fraction of the parcels where they are (n1,n2,n3)
  contains
    procedure :: create
    procedure :: begin
    procedure :: advance
    procedure :: next_step
  end type scene_t

contains

  !> An empty scene for a case.
  subroutine create(self, comm, case, outcome)
    class(scene_t), intent(out) :: self
    type(communicator_t), intent(in) :: comm
    type(case_t), intent(in) :: case
    type(outcome_t), intent(inout) :: outcome

    self%comm = comm
    self%with_gas = case%with_gas
    self%with_parcels = case%with_parcels
    self%limits = step_limits_of(case%gas_numerics)
    call self%watch%start(parts)
    if (self%with_gas) call create_gas(self, case, outcome)
    if (outcome%failed()) return
    associate (d => case%domain)
      if (.not. self%with_gas) self%mesh = new_uniform_mesh(d%lower, d%upper, cells_without_gas(d%upper - d%lower), d%periodic)
    end associate
    if (self%with_parcels) call self%solids%create(comm, enclosure_of(case), case%contact, case%des, self%with_gas, &
                                                   tile_width(self))
    if (self%with_gas .and. self%with_parcels) then
      call self%coupling%create(self%mesh, self%boxes, case%coupling, case%gas, case%domain%gravity)
      if (allocated(self%gas%space)) call self%coupling%narrow(self%gas%space)
    end if
  end subroutine create

  subroutine create_gas(self, case, outcome)
    type(scene_t), intent(inout) :: self
    type(case_t), intent(in) :: case
    type(outcome_t), intent(inout) :: outcome

    type(open_space_t), allocatable :: space
    integer :: i

    associate (d => case%domain)
      self%mesh = new_mesh(d%axis)
      call new_boxes(self%comm, d%cells, d%periodic, self%boxes, outcome)
      if (outcome%failed()) return
      if (any([(case%walls(i)%blocks_gas(), i=1, size(case%walls))])) call find_space(self, case, space, outcome)
      if (outcome%failed()) return
      call new_gas(self%boxes, self%mesh, case%gas, case%boundaries, case%gas_numerics, self%gas, outcome, space)
      self%gas%gravity = d%gravity
      if (.not. outcome%failed()) call self%gas%balance()
    end associate
    associate (n => self%boxes%n)
      allocate (self%mapped(n(1), n(2), n(3)), source=1.0_wp)
    end associate
  end subroutine create_gas

  !> What the walls leave to the gas.
  subroutine find_space(self, case, space, outcome)
    type(scene_t), intent(in) :: self
    type(case_t), intent(in) :: case
    type(open_space_t), allocatable, intent(out) :: space
    type(outcome_t), intent(inout) :: outcome

    type(blocking_walls_t) :: walls
    integer :: a

    walls = new_blocking_walls(case%walls, case%surfaces, self%mesh)
    do a = 1, 3
      if (.not. self%mesh%periodic(a)) cycle
      if (walls%meet_alike(self%mesh, a)) cycle
      call outcome%fail(exit_input, 'the walls leave different parts of the two faces across '//'xyz'(a:a)//' to the gas, and ' &
                        //'these are joined (periodic)')
      return
    end do
    allocate (space)
    call new_open_space(self%boxes, self%mesh, walls, space)
    if (all(space%first_open > 0)) return
    call outcome%fail(exit_input, 'the walls leave no cell to the gas: see gas_side of &wall')
  end subroutine find_space

  !> Cubes, about, a twentieth of the shortest edge wide.
  pure function cells_without_gas(extent) result(cells)
    real(wp), intent(in) :: extent(3)  !< of the domain [m]
    integer :: cells(3)

    cells = nint(20*extent/minval(extent))
  end function cells_without_gas

  !> Tiles of a gas cell or more, so that what a rank reads of the gas is not much more than its own.
  pure function tile_width(self) result(width)
    type(scene_t), intent(in) :: self
    real(wp) :: width

    width = 0.0_wp
    if (self%with_gas) width = maxval(self%mesh%coarsest)
  end function tile_width

  !> Length of the next gas step [s].
  pure function next_step(self) result(dt)
    class(scene_t), intent(in) :: self
    real(wp) :: dt

    dt = self%limits%longest/2**self%halvings
  end function next_step

  !> Show the gas the parcels that have been put in, so that what is written before the first step has their void fraction.
  subroutine begin(self)
    class(scene_t), intent(inout) :: self

    if (self%with_gas .and. self%with_parcels) call see_parcels(self)
  end subroutine begin

  !> One step of at most `limit`; a whole one where that is the same but for round-off, so that a run that ends and is
  !> continued takes the steps of one that never ended. All ranks agree on the outcome; where it failed nothing has
  !> moved since the last good step but, at worst, the parcels within the present one.
  subroutine advance(self, limit, outcome)
    class(scene_t), intent(inout) :: self
    real(wp), intent(in) :: limit  !< [s]
    type(outcome_t), intent(inout) :: outcome

    self%report = step_report_t(dt=self%next_step())
    if (limit < (1 - round_off)*self%report%dt) self%report%dt = limit
    if (self%with_gas) call advance_gas(self, outcome)
    if (outcome%failed()) return
    if (self%with_parcels) call advance_parcels(self, outcome)
    if (outcome%failed()) return
    self%time = self%time + self%report%dt
    self%steps = self%steps + 1
  end subroutine advance

  !> The gas, with as short a step as it takes to converge, and its force on the parcels.
  subroutine advance_gas(self, outcome)
    class(scene_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    logical :: converged
    real(wp) :: share

    if (self%with_parcels) call see_parcels(self)
    do
      share = seen_share(self)
      if (self%with_parcels) call prepare(self, share)
      call self%watch%enter(part_gas)
      self%gas%time = self%time
      call self%gas%advance(self%report%dt, converged)
      call self%watch%leave()
      if (converged) exit
      if (self%halvings >= self%limits%deepest) then
        call outcome%fail(exit_failed, no_convergence(self))
        return
      end if
      self%halvings = self%halvings + 1
      self%good_steps = 0
      self%report%retries = self%report%retries + 1
      self%report%dt = self%report%dt/2
    end do
    call self%gas%accept()
    self%unseen = (1 - share)*self%unseen
    call plan_step(self%limits, step_taken_t(self%time + self%report%dt, self%report%dt, self%report%retries, &
                                             self%gas%report%iterations, self%gas%report%courant), self%halvings, self%good_steps)
    if (.not. self%with_parcels) return
    self%unseen = self%unseen + self%report%dt
    call self%watch%enter(part_coupling)
    call self%coupling%drive(self%solids%parcels, self%gas, self%report%dt)
    call self%watch%leave()
  end subroutine advance_gas

  !> The void fraction where the parcels are; at the very start it has been so for ever.
  subroutine see_parcels(self)
    class(scene_t), intent(inout) :: self

    call self%watch%enter(part_coupling)
    call self%coupling%follow_tiles(self%solids%tiles, self%solids%largest_stray())
    call self%coupling%map_void_fraction(self%solids%parcels, self%gas)
    if (.not. self%begun) call self%gas%accept()
    self%begun = .true.
    associate (n => self%boxes%n)
      self%mapped = self%gas%eps(1:n(1), 1:n(2), 1:n(3))
    end associate
    call self%watch%leave()
  end subroutine see_parcels

  !> How much of the change of the void fraction a step of this length is shown.
  pure function seen_share(self) result(share)
    class(scene_t), intent(in) :: self
    real(wp) :: share

    share = 1.0_wp
    if (self%unseen > self%report%dt) share = self%report%dt/self%unseen
  end function seen_share

  subroutine prepare(self, share)
    class(scene_t), intent(inout) :: self
    real(wp), intent(in) :: share

    call self%watch%enter(part_coupling)
    associate (n => self%boxes%n, gas => self%gas)
      if (share >= 1.0_wp) then
        gas%eps(1:n(1), 1:n(2), 1:n(3)) = self%mapped
      else
        gas%eps(1:n(1), 1:n(2), 1:n(3)) = (1 - share)*gas%eps_old(1:n(1), 1:n(2), 1:n(3)) + share*self%mapped
      end if
    end associate
    ! since parcels were driven last the gas has not moved, or has been put back
    call self%coupling%prepare(self%solids%parcels, self%gas, self%report%dt, as_seen=.true.)
    call self%watch%leave()
  end subroutine prepare

  !> The parcels over the gas step.
  subroutine advance_parcels(self, outcome)
    class(scene_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    call self%watch%enter(part_parcels)
    self%report%solids_steps = max(1, ceiling(self%report%dt/self%solids%next_step_limit()))
    call self%solids%advance(self%report%solids_steps, self%report%dt/self%report%solids_steps, outcome)
    self%astray = outcome%failed()
    call self%watch%leave()
  end subroutine advance_parcels

  function no_convergence(self) result(message)
    class(scene_t), intent(in) :: self
    character(len=:), allocatable :: message

    associate (r => self%gas%report, n => self%gas%numerics)
      message = 'the gas did not converge at t = '//brief(self%time)//' s, even in steps of '//brief(self%report%dt) &
        //' s: after '//shown(r%iterations)//' iterations the mass residual is '//brief(r%mass_residual)//' (tolerance ' &
        //shown(n%tolerance)//') and the momentum residual '//brief(r%momentum_residual)//' (velocity_tolerance ' &
        //shown(n%velocity_tolerance)//'), largest at '//worst_place(self) &
        //'. Try a shorter time_step, more maximum_iterations, limiter = ''upwind'' or coarser cells'
    end associate
  end function no_convergence

  !> Where the gas mass is out of balance most, and the void fraction there. All ranks take part.
  function worst_place(self) result(words)
    class(scene_t), intent(in) :: self
    character(len=:), allocatable :: words

    real(wp) :: largest, facts(4)
    integer :: cell(3)

    largest = maxval(abs(self%gas%imbalance))
    facts = -huge(1.0_wp)
    if (largest >= self%comm%max(largest)) then
      cell = maxloc(abs(self%gas%imbalance))
      facts(1:3) = self%mesh%in_metres(self%boxes%lo + cell - 1.5_wp)
      facts(4) = self%gas%eps(cell(1), cell(2), cell(3))
    end if
    facts = self%comm%max(facts)
    words = '('//brief(facts(1))//', '//brief(facts(2))//', '//brief(facts(3))//') m, where the void fraction is '//brief(facts(4))
  end function worst_place

end module scene
