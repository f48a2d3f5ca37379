!> One run, from the case to the last line it prints.
module simulation
  use, intrinsic :: iso_fortran_env, only: output_unit
  use agreement, only: agree
  use case, only: case_t
  use chamber, only: chamber_t
  use checkpoint, only: write_checkpoint, read_checkpoint
  use cloud, only: cloud_t
  use communicator, only: communicator_t
  use cost, only: print_cost
  use files, only: exists, make_folder
  use generator, only: generate
  use kinds, only: wp, i8
  use ledger, only: ledger_t
  use outcome, only: outcome_t, exit_input, exit_stopped
  use progress, only: progress_t
  use provenance, only: provenance_t
  use results, only: results_t
  use scene, only: scene_t, part_output
  use schedule, only: schedule_t, new_schedule
  use signals, only: catch_signals
  use size_audit, only: size_audit_t, write_audit
  use solids_statistics, only: find_statistics
  use stop_request, only: stop_request_t
  use text, only: brief, shown
  use version, only: program_version, git_commit
  use vessel, only: vessel_t
  implicit none
  private
  public :: simulation_t, orders_t

  real(wp), parameter :: last_bit = 1.0e-5_wp  !< of a step: what is left of the run when it counts as done

  !> What the command line asks for beside the case.
  type :: orders_t
    character(len=:), allocatable :: folder    !< of the results
    character(len=:), allocatable :: restart   !< file to go on from, '' for none
    logical :: force = .false.                 !< replace results that are there
  end type orders_t

  type :: simulation_t
    type(communicator_t) :: comm
    type(case_t) :: case
    type(orders_t) :: orders
    type(provenance_t) :: origin
    type(scene_t) :: scene
    type(ledger_t) :: ledger
    type(results_t) :: results
    type(progress_t) :: progress
    type(schedule_t) :: restart_due
    type(stop_request_t) :: stop
    type(size_audit_t), allocatable :: audits(:)  !< on the root: the powders asked for and those made
    real(wp) :: time_at_start = 0                 !< simulated [s]
    type(ledger_t) :: ledger_at_start
    logical :: writing = .false.                  !< whether the files are open
  contains
    procedure :: set_up
    procedure :: run
    procedure :: finish
  end type simulation_t

contains

  !> Everything up to the first step. Nothing is written unless all of it succeeds.
  subroutine set_up(self, comm, case, orders, outcome)
    class(simulation_t), intent(inout) :: self
    type(communicator_t), intent(in) :: comm
    type(case_t), intent(in) :: case
    type(orders_t), intent(in) :: orders
    type(outcome_t), intent(inout) :: outcome

    self%comm = comm
    self%case = case
    self%orders = orders
    ! One by one: gfortran 12 gives too little room to texts in a structure constructor.
    self%origin%title = trim(case%run%title)
    self%origin%version = program_version
    self%origin%commit = git_commit
    self%origin%case = case%text
    call catch_signals()
    call refuse_overwriting(self, outcome)
    if (outcome%failed()) return
    call self%scene%create(comm, case, outcome)
    if (outcome%failed()) return
    if (len(orders%restart) > 0) then
      call read_checkpoint(orders%restart, self%scene, self%ledger, outcome)
    else if (case%with_parcels) then
      call fill_vessel(self, outcome)
      if (.not. outcome%failed()) call self%scene%begin()
    end if
    if (outcome%failed()) return
    self%time_at_start = self%scene%time
    self%ledger_at_start = self%ledger
    call open_files(self, outcome)
    call self%progress%start(trim(case%output%progress), comm%is_root(), self%scene%time, case%run%end_time)
  end subroutine set_up

  !> Results of an earlier run stay unless the user says otherwise.
  subroutine refuse_overwriting(self, outcome)
    class(simulation_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    character(len=*), parameter :: names(4) = [character(len=14) :: 'parcels.vtkhdf', 'gas.vtkhdf', 'monitor.h5', 'restart.h5']
    integer :: i

    if (self%comm%is_root() .and. .not. self%orders%force .and. len(self%orders%restart) == 0) then
      do i = 1, size(names)
        if (.not. exists(self%orders%folder//'/'//trim(names(i)))) cycle
        call outcome%fail(exit_input, 'there are results in '//self%orders%folder//' already: give --force to replace them, ' &
                          //'--restart '//self%orders%folder//'/restart.h5 to continue them, or another folder with --out')
      end do
    end if
    call agree(self%comm, outcome)
  end subroutine refuse_overwriting

  !> The parcels of the case. One rank makes them, so they are the same whatever the number of ranks.
  subroutine fill_vessel(self, outcome)
    class(simulation_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    type(cloud_t) :: cloud
    type(vessel_t) :: vessel

    if (self%comm%is_root()) then
      vessel = vessel_t(self%case%domain%lower, self%case%domain%upper, self%case%domain%periodic)
      call generate(self%case%powders, self%case%parcels, self%case%fills, vessel, cloud, self%audits, outcome)
      if (.not. outcome%failed()) call check_places(self%scene%solids%chamber, self%case, cloud, outcome)
    end if
    call agree(self%comm, outcome)
    if (outcome%failed()) return
    if (.not. self%comm%is_root()) allocate (cloud%position(3, 0), cloud%velocity(3, 0), cloud%diameter(0), &
                                             cloud%weight(0), cloud%density(0), cloud%powder(0), cloud%id(0))
    call self%scene%solids%add(cloud%position, cloud%velocity, cloud%diameter, cloud%weight, cloud%density, &
                               cloud%powder, cloud%id)
    outcome = self%scene%solids%trouble
  end subroutine fill_vessel

  !> No parcel starts beyond a wall; where a fill is a box that is known already.
  pure subroutine check_places(chamber, case, cloud, outcome)
    type(chamber_t), intent(in) :: chamber
    type(case_t), intent(in) :: case
    type(cloud_t), intent(in) :: cloud
    type(outcome_t), intent(inout) :: outcome

    integer :: i

    do i = 1, cloud%n
      if (.not. chamber%is_beyond(cloud%position(:, i), 0.5_wp*cloud%contact_diameter(i))) cycle
      call outcome%fail(exit_input, '&fill('//trim(case%fills(cloud%fill(i))%id)//'): its parcel at '// &
                        shown(cloud%position(:, i))//' m is beyond a &wall, or in one')
      return
    end do
  end subroutine check_places

  subroutine open_files(self, outcome)
    class(simulation_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    if (self%comm%is_root()) call make_folder(self%orders%folder, outcome)
    call agree(self%comm, outcome)
    if (outcome%failed()) return
    call self%stop%start(self%comm, self%orders%folder, self%case%run%wall_clock_limit)
    if (len(self%orders%restart) > 0) then
      call self%results%open(self%orders%folder, self%case, self%scene, self%origin, outcome, self%scene%time)
      self%restart_due = new_schedule(self%case%output%restart_interval, self%scene%time)
    else
      call self%results%open(self%orders%folder, self%case, self%scene, self%origin, outcome)
      self%restart_due = new_schedule(self%case%output%restart_interval, 0.0_wp)
    end if
    self%writing = .not. outcome%failed()
    if (self%writing .and. allocated(self%audits)) call self%results%annotate(self%audits)
  end subroutine open_files

  !> The time loop. Ends at the end time, at a failure, or where it is asked to stop.
  subroutine run(self, outcome)
    class(simulation_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    real(wp) :: left

    call introduce(self)
    call write_output(self, outcome)
    do
      left = self%case%run%end_time - self%scene%time
      if (outcome%failed() .or. left <= last_bit*self%scene%next_step()) exit
      call self%scene%advance(left, outcome)
      if (outcome%failed()) exit
      call self%ledger%enter_step(self%scene)
      call write_output(self, outcome)
      call show_progress(self)
      call look_for_stop(self, outcome)
    end do
    call write_last_state(self, outcome)
  end subroutine run

  !> All files that are due.
  subroutine write_output(self, outcome)
    class(simulation_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    if (outcome%failed()) return
    call self%scene%watch%enter(part_output)
    call self%results%write_due(self%scene, self%ledger, self%scene%watch%seconds(), outcome)
    if (.not. outcome%failed() .and. self%restart_due%is_due(self%scene%time)) then
      call self%restart_due%done(self%scene%time)
      call write_checkpoint(restart_name(self), self%scene, self%ledger, self%origin, outcome)
    end if
    call self%scene%watch%leave()
  end subroutine write_output

  !> The restart file of the end, however the run has ended. After a failure it is kept apart, as the state may hold
  !> what made the run fail.
  subroutine write_last_state(self, outcome)
    class(simulation_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    type(outcome_t) :: writing

    call self%scene%watch%enter(part_output)
    if (outcome%failed() .and. outcome%code /= exit_stopped) then
      call self%results%write_all(self%scene, self%ledger, self%scene%watch%seconds(), writing)
      call write_checkpoint(failed_name(self), self%scene, self%ledger, self%origin, writing)
      if (.not. writing%failed()) outcome%message = outcome%message//what_failed_holds(self)
    else
      call write_checkpoint(restart_name(self), self%scene, self%ledger, self%origin, writing)
    end if
    call self%results%close(writing)
    call self%scene%watch%leave()
    if (writing%failed()) call outcome%fail(writing%code, writing%message)
  end subroutine write_last_state

  !> End the run where a signal, the wall clock or a stop file asks for it; every rank comes to the same decision.
  subroutine look_for_stop(self, outcome)
    class(simulation_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    if (outcome%failed()) return
    if (.not. self%stop%is_made(self%comm)) return
    call outcome%fail(exit_stopped, 'stopped by '//self%stop%reason()//' at t = '//brief(self%scene%time) &
                      //' s; go on with --restart '//restart_name(self))
  end subroutine look_for_stop

  subroutine show_progress(self)
    class(simulation_t), intent(inout) :: self

    integer :: iterations
    integer(i8) :: parcels

    iterations = 0
    parcels = 0
    if (self%scene%with_gas) iterations = self%scene%gas%report%iterations
    if (self%scene%with_parcels) parcels = self%scene%solids%added - self%scene%solids%left
    call self%progress%update(self%scene%time, self%scene%report%dt, iterations, parcels)
  end subroutine show_progress

  !> What this run is, before its first step.
  subroutine introduce(self)
    class(simulation_t), intent(inout) :: self

    integer :: i

    if (.not. self%comm%is_root()) return
    call self%progress%say('geldart '//program_version//' ('//git_commit//'), '//shown(self%comm%size)//' ranks: ' &
                           //self%case%file)
    if (len_trim(self%case%run%title) > 0) call self%progress%say('  '//trim(self%case%run%title))
    if (len(self%orders%restart) > 0) then
      call self%progress%say('  continues '//self%orders%restart//' at t = '//brief(self%scene%time)//' s')
    end if
    if (allocated(self%audits)) then
      do i = 1, size(self%audits)
        call write_audit(output_unit, self%audits(i))
      end do
    end if
    if (allocated(self%scene%gas%space)) then
      associate (space => self%scene%gas%space)
        call self%progress%say('walls leave '//brief(space%open_volume)//' m3 to the gas; '//shown(space%lost_cells) &
                               //' cells that are hardly open are closed, with '//brief(space%lost_volume)//' m3')
        if (space%pockets > 0) call self%progress%say('warning: '//shown(space%pockets)//' parts of the domain with ' &
          //brief(space%pocket_volume)//' m3 have no way to an outflow and are closed to the gas, the first about (' &
          //brief(space%pocket_place(1))//', '//brief(space%pocket_place(2))//', '//brief(space%pocket_place(3))//') m')
      end associate
    end if
    if (self%scene%with_parcels) call self%progress%say( &
      'solids step at most '//brief(self%scene%solids%time_step_limit())//' s, gas step at most ' &
      //brief(self%scene%limits%longest)//' s')
  end subroutine introduce

  !> Books and bill.
  subroutine finish(self, outcome)
    class(simulation_t), intent(inout) :: self
    type(outcome_t), intent(in) :: outcome

    integer(i8) :: lost
    real(wp) :: lost_mass

    if (.not. self%writing) return
    lost = 0
    lost_mass = 0
    if (self%scene%with_parcels) then
      associate (s => find_statistics(self%scene%solids))
        lost = s%lost
        lost_mass = self%scene%solids%mass_added - s%mass_left - s%mass
      end associate
    end if
    if (self%comm%is_root() .and. .not. outcome%failed()) call self%progress%finish(self%scene%time)
    if (self%comm%is_root()) call self%ledger%print(self%scene, lost, lost_mass, output_unit)
    if (self%comm%is_root() .and. self%scene%with_parcels) call self%results%overlaps%print(self%case%contact, output_unit)
    call print_cost(self%scene, self%ledger, self%ledger_at_start, self%time_at_start)
    if (self%comm%is_root()) print '(2a)', 'results in ', self%orders%folder
    if (self%scene%with_gas) call self%scene%gas%destroy()
  end subroutine finish

  !> What may be done with the state that is written after a failure.
  pure function what_failed_holds(self) result(words)
    class(simulation_t), intent(in) :: self
    character(len=:), allocatable :: words

    if (self%scene%astray) then
      words = '; '//failed_name(self)//' shows the parcels as they are, but cannot be continued: a restart file from before can'
    else
      words = '; the last good state is in '//failed_name(self)//': change the case and go on with --restart'
    end if
  end function what_failed_holds

  pure function failed_name(self) result(name)
    class(simulation_t), intent(in) :: self
    character(len=:), allocatable :: name

    name = self%orders%folder//'/failed.h5'
  end function failed_name

  pure function restart_name(self) result(name)
    class(simulation_t), intent(in) :: self
    character(len=:), allocatable :: name

    name = self%orders%folder//'/restart.h5'
  end function restart_name

end module simulation
